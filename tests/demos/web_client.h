#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace ragtop {

/// A blocking HTTP and WebSocket client, right or wrong, on one connection to 127.0.0.1. What does not come within the
/// time limit counts as the end of the connection.
class WebClient {
public:
    struct Options {
        const char* address = "127.0.0.1";
        double seconds = 30;    ///< limit of every wait
        int receiveBuffer = 0;  ///< of the system, bytes; 0: its default
    };
    /// Throws std::runtime_error when nobody listens.
    explicit WebClient(int port, const Options& options);
    explicit WebClient(int port) : WebClient(port, Options{}) {}
    ~WebClient();
    WebClient(WebClient&& other) noexcept;
    WebClient& operator=(WebClient&&) = delete;

    /// False when the other side has closed.
    bool send(std::string_view bytes);
    /// Tells that nothing more will be sent.
    void finish();
    /// All that comes until the other side closes.
    std::string receiveAll();

    struct Answer {
        int status = 0;                             ///< 0: none
        std::map<std::string, std::string> fields;  ///< by name in lower case
        std::string body;
    };
    /// `fields` are whole lines, each ended by \r\n; Host is among them unless it is added.
    Answer get(std::string_view target, std::string_view fields = {});
    Answer request(std::string_view start, std::string_view fields);
    Answer receiveAnswer();

    /// Turns the connection into a WebSocket; gives the status of the answer, which is 101 then.
    int open(std::string_view fields = {});

    enum Opcode { kContinuation = 0, kText = 1, kBinary = 2, kClose = 8, kPing = 9, kPong = 10 };
    struct Frame {
        int opcode = kText;
        std::string payload;
        /// Of a close frame.
        int closeCode() const;
    };
    bool say(std::string_view message) { return sendFrame(kText, message); }
    bool sendFrame(int opcode, std::string_view payload, bool last = true);
    /// Announces a payload that may or may not follow.
    static std::string frameHeader(int opcode, std::size_t size, bool last = true);
    /// The next frame that is no ping; pings are answered. None: the connection has ended.
    std::optional<Frame> receive();
    /// The next text message that holds `part`; empty: the connection has ended.
    std::string receiveTextWith(std::string_view part);

    int port() const { return port_; }

private:
    bool fill();
    std::optional<std::string> take(std::size_t count);
    std::optional<std::string> takeLine();

    int port_ = 0;
    int socket_ = -1;
    std::string received_;
    std::size_t taken_ = 0;
};

}  // namespace ragtop
