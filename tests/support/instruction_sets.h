#pragma once

#include <gtest/gtest.h>
#include <hwy/highway.h>

namespace lorica::test {

/// Calls a function once for each instruction set that this machine has and the program was compiled for, with that set
/// in use.
template <class Function>
void onEveryInstructionSet(const Function& function) {
  const auto use = [](std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  };
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    use(target);
    function();
    use(0);
  }
}

}  // namespace lorica::test
