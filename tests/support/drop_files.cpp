// Drops files on a window, as a file manager does: drop_files WINDOW FILE... Speaks the XDND protocol, version 5.
#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>

namespace {

Display* gDisplay = nullptr;

Atom atom(const char* name) {
  return XInternAtom(gDisplay, name, False);
}

void send(Window from, Window to, const char* what, long a, long b, long c, long d) {
  XEvent event = {};
  event.xclient.type = ClientMessage;
  event.xclient.window = to;
  event.xclient.message_type = atom(what);
  event.xclient.format = 32;
  const long values[] = {static_cast<long>(from), a, b, c, d};
  std::memcpy(event.xclient.data.l, values, sizeof values);
  XSendEvent(gDisplay, to, False, NoEventMask, &event);
  XFlush(gDisplay);
}

/// The window asks for the names of the files.
void answer(const XSelectionRequestEvent& request, const std::string& uris) {
  XChangeProperty(gDisplay, request.requestor, request.property, request.target, 8, PropModeReplace,
                  reinterpret_cast<const unsigned char*>(uris.data()), static_cast<int>(uris.size()));
  XEvent event = {};
  event.xselection.type = SelectionNotify;
  event.xselection.requestor = request.requestor;
  event.xselection.selection = request.selection;
  event.xselection.target = request.target;
  event.xselection.property = request.property;
  event.xselection.time = request.time;
  XSendEvent(gDisplay, request.requestor, False, NoEventMask, &event);
  XFlush(gDisplay);
}

}  // namespace

int main(int count, char** arguments) {
  gDisplay = XOpenDisplay(nullptr);
  if (gDisplay == nullptr || count < 3) return 2;
  const auto target = static_cast<Window>(std::strtoul(arguments[1], nullptr, 0));
  std::string uris;
  for (int i = 2; i < count; ++i) uris += std::string("file://") + arguments[i] + "\r\n";
  const Window source = XCreateSimpleWindow(gDisplay, DefaultRootWindow(gDisplay), 0, 0, 1, 1, 0, 0, 0);
  const Atom selection = atom("XdndSelection");
  XSetSelectionOwner(gDisplay, selection, source, CurrentTime);
  send(source, target, "XdndEnter", 5L << 24, static_cast<long>(atom("text/uri-list")), 0, 0);
  send(source, target, "XdndPosition", 0, 40L << 16 | 40, CurrentTime, static_cast<long>(atom("XdndActionCopy")));
  const std::time_t end = std::time(nullptr) + 20;
  while (std::time(nullptr) < end) {
    if (XPending(gDisplay) == 0) {
      const timespec pause = {0, 5'000'000};
      nanosleep(&pause, nullptr);
      continue;
    }
    XEvent event;
    XNextEvent(gDisplay, &event);
    if (event.type == SelectionRequest) answer(event.xselectionrequest, uris);
    if (event.type != ClientMessage) continue;
    if (event.xclient.message_type == atom("XdndStatus")) send(source, target, "XdndDrop", 0, CurrentTime, 0, 0);
    if (event.xclient.message_type == atom("XdndFinished")) return 0;
  }
  std::fputs("the window did not take the files\n", stderr);
  return 1;
}
