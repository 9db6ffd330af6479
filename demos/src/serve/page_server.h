#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace ragtop {

/// Names one page (WebSocket) while it is connected; never used again after.
using ClientId = std::uint32_t;
/// The bytes of a frame, shared by all pages that get it.
using FrameBytes = std::shared_ptr<const std::vector<std::byte>>;

/// Where the server listens and how much it bears; nothing grows without a limit.
struct PageServerOptions {
    int port = 8080;             ///< 0: any free one
    std::filesystem::path page;  ///< HTML file given at "/", read once; empty: a short text says how to build it

    std::size_t clients = 16;                ///< pages at once; further ones get 503
    /// Open sockets at once, pages among them. A further one ends the one that has longest not asked for anything;
    /// where all are pages or read an answer, it waits.
    std::size_t connections = 64;
    std::size_t messageBytes = 64 * 1024;    ///< of one message from a page; longer ones close it with 1009
    std::size_t unreadMessages = 256;        ///< of one page; further ones are dropped with an error answer
    std::size_t unreadBytes = 4 << 20;       ///< of all pages; likewise
    std::size_t unsentBytes = 32 << 20;      ///< for one page; beyond it is cut off
    std::size_t publishedBytes = 256 << 20;  ///< of all files; beyond, those published first are forgotten
    double lagSeconds = 0.1;                 ///< frames go to pages that have read what was sent longer ago
    double requestSeconds = 10;              ///< for a whole request to arrive, and for its answer to leave
    double silenceSeconds = 30;              ///< a page that has not read what was sent longer ago is cut off
};

/// Serves one HTML page, published files and WebSocket connections (at /live) to the machine it runs on: it listens on
/// 127.0.0.1 only and answers only requests whose Host, and Origin where there is one, name it by that address and port.
/// It never opens a file for a request.
///
/// All work on sockets is done in a thread of its own. The member functions never block on a page; they may be called
/// from any one thread at a time.
class PageServer {
public:
    /// Starts to listen. Throws std::runtime_error when the port is taken or the page cannot be read.
    explicit PageServer(const PageServerOptions& options = {});
    /// Closes every connection.
    ~PageServer();
    PageServer(const PageServer&) = delete;
    PageServer& operator=(const PageServer&) = delete;

    int port() const;

    enum class MessageKind : std::uint8_t { joined, said, left };
    /// Per client: joined once, said any number of times, left once and last.
    struct Message {
        ClientId client = 0;
        MessageKind kind = MessageKind::said;
        std::string text;  ///< valid UTF-8; empty unless said
    };
    /// Takes the oldest message; false when there is none. A page can send as fast as they are taken, so take a bounded
    /// number between two steps.
    bool receive(Message& into);
    /// Returns when a message waits, or after so many seconds.
    bool wait(double seconds);

    /// Pages in the order they joined: those whose `joined` has been received and whose `left` has not. What is sent to
    /// a page that is gone is dropped.
    std::vector<ClientId> clients() const;
    /// Whether the page keeps up: it has read what was sent longer ago than PageServerOptions::lagSeconds, and no frame
    /// waits here. Send frames only to pages that are ready; those that are not skip frames.
    bool ready(ClientId client) const;
    /// Reliable and in order; text (UTF-8) and frames arrive in the order sent. A page that lets more than
    /// PageServerOptions::unsentBytes pile up is cut off.
    void send(ClientId client, std::string text);
    /// The same for a binary message. All frames of one step may be sent once ready() was true.
    void sendFrame(ClientId client, FrameBytes frame);

    /// Gives the bytes at /visual/<name>, instead of earlier ones of that name. Throws std::invalid_argument unless the
    /// name is of letters, digits, '.', '_' and '-', the media type ("model/gltf-binary") is printable ASCII, and the
    /// bytes alone are within PageServerOptions::publishedBytes.
    void publish(const std::string& name, const std::string& mime, std::vector<std::byte> bytes);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace ragtop
