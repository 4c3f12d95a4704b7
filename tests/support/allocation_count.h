#pragma once

namespace lorica::test {

/// How often this program has asked for memory so far. A program that calls it has operator new counted.
[[nodiscard]] long allocationCount();

}  // namespace lorica::test
