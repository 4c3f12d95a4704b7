#!/usr/bin/perl
# A document as a page: links lead to other documents, pictures and the web only; a film is shown. Doxygen knows no anchors of
# headings, and no links that go on in the next line. Its own labels of pages change with its version, so each page has one:
# page_docs_START.
use strict;
use warnings;
use Cwd;

local $/;
while (<>) {
  (my $label = $ARGV) =~ s{^\Q${\ getcwd}\E/|\.md$}{}g;
  $label =~ tr{/}{_};
  s{\A(# .*)}{$1 {#page_$label}} unless $label eq 'docs_GALLERY';  # the main page
  s{(?<!!)\[[^\]]+\]\((?:[^)]*/)?([^)/]+\.mp4)\)}{\@htmlonly<video src="$1" controls muted loop></video>\@endhtmlonly}g;
  s{(?<!!)\[((?:(?!\n\n)[^\]])+)\]\((?!https?:)([^)#]*)(?:#[^)]*)?\)}{my ($text, $file) = ($1, $2); $text =~ tr/\n/ /; $file =~ /\.md$/ ? "[$text]($file)" : $text}ge;
  print;
}
