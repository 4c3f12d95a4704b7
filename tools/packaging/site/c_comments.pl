#!/usr/bin/perl
# The comments of the C header as Doxygen's: behind a member its own, else that of what follows.
use strict;
use warnings;

my $first = 1;
while (<>) {
  $first = 0 if $first && s{^/\*}{/** \@file lorica.h\n * };
  s{^(\s*)/\*(?!\*)}{$1/**};
  s{([;,]\s+|[A-Z0-9_]\s+)/\*(?!\*)}{$1/**<};
  print;
}
