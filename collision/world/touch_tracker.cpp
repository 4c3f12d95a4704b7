#include "collision/world/touch_tracker.h"

#include "geometry/result.h"

#include <algorithm>
#include <iterator>

namespace lorica {
namespace {

bool begins(const Touch& touch) {
  return touch.pair.kind == TouchKind::kProp || touch.depth >= TouchTracker::kBeginDepth;
}

ContactEvent begun(const Touch& touch, double time) {
  return {ContactPhase::kBegin, touch, time, time, time};
}

ContactEvent continued(const ContactEvent& contact, const Touch& touch, double time) {
  ContactEvent event{ContactPhase::kStay, touch, time, contact.began, time};
  event.touch.bone = contact.touch.bone;
  event.touch.otherBone = contact.touch.otherBone;
  return event;
}

/// A contact that is not touched in this frame: it stays for a while, then ends.
ContactEvent left(const ContactEvent& contact, double time) {
  ContactEvent event = contact;
  const double since = time - contact.touched;
  event.phase = since >= 0.0 && since < TouchTracker::kReleaseSeconds ? ContactPhase::kStay : ContactPhase::kEnd;
  event.touch.depth = event.touch.strength = 0.0;
  event.time = time;
  return event;
}

}  // namespace

std::span<const ContactEvent> TouchTracker::update(std::span<const Touch> touches, double time) {
  LORICA_CHECK(std::adjacent_find(touches.begin(), touches.end(),
                                  [](const Touch& a, const Touch& b) { return !(a.pair < b.pair); }) == touches.end(),
               "touches must be in ascending order of their pairs");
  time_ = time;
  events_.clear();
  auto contact = open_.begin();
  auto touch = touches.begin();
  while (contact != open_.end() || touch != touches.end()) {
    const bool isOpen = contact != open_.end() && (touch == touches.end() || !(touch->pair < contact->touch.pair));
    const bool isTouched = touch != touches.end() && (contact == open_.end() || !(contact->touch.pair < touch->pair));
    if (isOpen && isTouched) {
      events_.push_back(continued(*contact, *touch, time));
    } else if (isOpen) {
      events_.push_back(left(*contact, time));
    } else if (begins(*touch)) {
      events_.push_back(begun(*touch, time));
    }
    if (isOpen) ++contact;
    if (isTouched) ++touch;
  }
  open_.clear();
  std::copy_if(events_.begin(), events_.end(), std::back_inserter(open_),
               [](const ContactEvent& event) { return event.phase != ContactPhase::kEnd; });
  return events_;
}

std::span<const ContactEvent> TouchTracker::endAll() {
  events_.clear();
  for (ContactEvent& contact : open_) {
    contact.phase = ContactPhase::kEnd;
    contact.touch.depth = contact.touch.strength = 0.0;
    contact.time = time_;
    events_.push_back(contact);
  }
  open_.clear();
  return events_;
}

}  // namespace lorica
