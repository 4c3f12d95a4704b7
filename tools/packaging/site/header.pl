#!/usr/bin/perl
# A C++ header without what every reader knows: copies and moves, and operators that are defaulted.
use strict;
use warnings;

while (<>) {
  s{^\s*(?:explicit )?(\w+)\((?:const \1&|\1&&)(?: \w+)?\)(?: noexcept)?(?: = default)?;$}{};
  s{^\s*\w+& operator=\((?:const )?\w+&&?(?: \w+)?\)(?: noexcept)?(?: = default)?;$}{};
  s{^.* operator==\(.*\) const = default;$}{};
  s{^\s*friend bool operator==\(.*\) = default;$}{};
  print;
}
