#pragma once

#include "geometry/named_file.h"
#include "geometry/result.h"
#include "viewer/page/client_message.h"
#include "viewer/page/wire.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Where sessions are served and who may see them.
struct ServeSetting {
  int port = 0;             ///< 0 = the first free one from kUsualPort on
  bool lan = false;         ///< on all networks, with TLS and a token; else for this machine alone
  std::string certificate;  ///< PEM file of `lan`; empty = Lorica's own, which is made and kept
  std::string key;          ///< its private key
  std::string recordings;   ///< folder that clients may record sessions into, made if it is missing; empty = none. The
                            ///< files that they open are kept in a folder in it
  PathTrust paths = PathTrust::kBeneath;  ///< which files a file may name
};
inline constexpr int kUsualPort = 8420;

/// What clients are told of a run before its frames.
struct ServedCast {
  std::uint32_t run = 0;                                       ///< as in the message; frames have it too
  std::string hello;                                           ///< the message
  std::vector<std::shared_ptr<const std::string>> characters;  ///< /character/N.glb
};

/// Messages of which each client has the newest one.
enum class ServedText : std::uint8_t { kControls, kState };
inline constexpr std::size_t kServedTexts = 2;

/// Limits of what clients may take.
struct ServeLimits {
  int clients = 32;                 ///< that watch at a time
  int connections = 96;             ///< of those who have shown the token, or watch where none is needed
  int strangers = 32;               ///< of all others; the oldest goes when another comes
  int strangersOfAnAddress = 8;     ///< of these: a browser opens six at a time
  int messagesASecond = 180;        ///< of one client: acknowledgements, two hands, a headset
  double requestSeconds = 5.0;      ///< until a request, a handshake or an answer is through
  double writeSeconds = 5.0;        ///< for a message; a client that reads nothing is dropped
  double goodbyeSeconds = 3.0;      ///< for a client to read that the session is over, and to answer
  double fileBytesASecond = 250e3;  ///< that a client sends a file with, at least
  std::size_t headerBytes = 8192;   ///< of a request
};

/// What is known of a server that was started.
struct ServerFacts {
  int port = 0;
  std::vector<std::string> links;   ///< one for each address of this machine: with the token
  std::string token;                ///< empty = none is needed
  std::string fingerprint;          ///< SHA-256 of the certificate, as browsers show it; empty without TLS
  bool certificateRenewed = false;  ///< the one that was kept is not for the addresses of today: another was made
  std::filesystem::path sentFiles;  ///< where files are kept that clients open; empty = nowhere
  std::string_view noSentFiles;     ///< why they cannot open any; empty = they can. With static storage duration
};

/// The server: HTTP and one WebSocket on one port, in a thread of its own. The session's thread hands frames over and
/// takes messages; it never waits for a client.
class PageServer {
 public:
  /// @return the server; or that the port is taken, or a certificate cannot be read
  [[nodiscard]] static Result<std::unique_ptr<PageServer>> start(const ServeSetting& setting,
                                                                 const ServeLimits& limits = {});
  /// Says goodbye to all clients.
  ~PageServer();

  [[nodiscard]] const ServerFacts& facts() const;
  [[nodiscard]] int port() const { return facts().port; }

  // For the session's thread.
  /// What the clients want to see, together; 0 = there are none or no layers are wanted.
  [[nodiscard]] unsigned layers() const;
  [[nodiscard]] int clients() const;
  void setCast(std::shared_ptr<const ServedCast> cast);
  /// The frame to fill, whose memory is that of an earlier one; publish() hands it over.
  [[nodiscard]] ServedFrame& next();
  void publish();
  /// The message of a kind that comes when it is another; the same text is not sent again.
  void set(ServedText kind, std::string text);
  /// A message to all clients, which must be rare. @param text  JSON
  void say(std::string text);
  /// The messages since the last call, but kAck and kShow. @param messages  appended
  void takeMessages(std::vector<ClientMessage>& messages);
  /// Waits for a message, at most so long.
  void waitForMessage(double seconds);

 private:
  PageServer();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lorica
