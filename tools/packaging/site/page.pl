#!/usr/bin/perl
# A document as a page: links lead to other documents, pictures and the web only; a film is shown. Doxygen knows no anchors of
# headings, and no links that go on in the next line.
use strict;
use warnings;

local $/;
while (<>) {
  s{(?<!!)\[[^\]]+\]\((?:[^)]*/)?([^)/]+\.mp4)\)}{\@htmlonly<video src="$1" controls muted loop></video>\@endhtmlonly}g;
  s{(?<!!)\[((?:(?!\n\n)[^\]])+)\]\((?!https?:)([^)#]*)(?:#[^)]*)?\)}{my ($text, $file) = ($1, $2); $text =~ tr/\n/ /; $file =~ /\.md$/ ? "[$text]($file)" : $text}ge;
  print;
}
