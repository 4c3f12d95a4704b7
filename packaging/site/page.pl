#!/usr/bin/perl
# A document as a page: links lead to other documents, pictures and the web only. Doxygen knows no anchors of headings.
use strict;
use warnings;

local @ARGV = @ARGV;
while (<>) {
  s{(?<!!)\[([^\]]+)\]\((?!https?:)([^)#]*)(?:#[^)]*)?\)}{my ($text, $file) = ($1, $2); $file =~ /\.md$/ ? "[$text]($file)" : $text}ge;
  print;
}
