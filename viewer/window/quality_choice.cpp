#include "viewer/window/quality_choice.h"

#include <algorithm>

namespace lorica {
namespace {

constexpr double kJudged = 1.0;  // [s]
constexpr double kEasy = 0.25;   // of the longest time
constexpr int kEasySeconds = 3;
constexpr double kSoon = 5.0;  // a level that is lowered within this time was too slow [s]
constexpr double kLongestWait = 160.0;
constexpr int kFewestPictures = 3;

}  // namespace

bool QualityChoice::add(double seconds, double now) {
  if (begin_ < 0.0) begin_ = now;
  sum_ += seconds;
  ++pictures_;
  if (now - begin_ < kJudged || pictures_ < kFewestPictures) return false;
  const double mean = sum_ / pictures_;
  begin_ = now;
  sum_ = 0.0;
  pictures_ = 0;
  easySeconds_ = mean < kEasy * longest_ ? easySeconds_ + 1 : 0;
  if (mean > longest_ && level_ > 0) {
    --level_;
    if (now - raisedAt_ < kSoon) {
      notBefore_ = now + waitNext_;
      waitNext_ = std::min(2.0 * waitNext_, kLongestWait);
    }
    return true;
  }
  if (easySeconds_ >= kEasySeconds && level_ < highest_ && now >= notBefore_) {
    ++level_;
    easySeconds_ = 0;
    raisedAt_ = now;
    return true;
  }
  return false;
}

}  // namespace lorica
