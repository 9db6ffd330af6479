#include "web_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace ragtop {

namespace {

/// Key and answer of the example in RFC 6455, 1.3.
constexpr std::string_view kKey = "dGhlIHNhbXBsZSBub25jZQ==", kAccept = "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=";
constexpr unsigned char kMask[4] = {0x37, 0xfa, 0x21, 0x3d};

timeval toTimeval(double seconds) {
    const double whole = std::floor(seconds);
    return {static_cast<time_t>(whole), static_cast<suseconds_t>((seconds - whole) * 1e6)};
}

std::string lowered(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

}  // namespace

WebClient::WebClient(int port, const Options& options) : port_(port), socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval limit = toTimeval(options.seconds);
    const int on = 1;
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (options.receiveBuffer) {
        setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &options.receiveBuffer, sizeof options.receiveBuffer);
    }
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<in_port_t>(port));
    inet_pton(AF_INET, options.address, &address.sin_addr);
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        ::close(socket_);
        throw std::runtime_error("nobody listens");
    }
}

WebClient::~WebClient() {
    if (socket_ >= 0) ::close(socket_);
}

WebClient::WebClient(WebClient&& other) noexcept
    : port_(other.port_),
      socket_(std::exchange(other.socket_, -1)),
      received_(std::move(other.received_)),
      taken_(other.taken_) {}

bool WebClient::send(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (count <= 0) return false;
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
}

void WebClient::finish() { shutdown(socket_, SHUT_WR); }

bool WebClient::fill() {
    if (taken_ > 0) {
        received_.erase(0, taken_);
        taken_ = 0;
    }
    std::array<char, 1 << 16> chunk;
    const ssize_t count = recv(socket_, chunk.data(), chunk.size(), 0);
    if (count <= 0) return false;
    received_.append(chunk.data(), static_cast<std::size_t>(count));
    return true;
}

std::optional<std::string> WebClient::take(std::size_t count) {
    while (received_.size() - taken_ < count) {
        if (!fill()) return {};
    }
    taken_ += count;
    return received_.substr(taken_ - count, count);
}

std::optional<std::string> WebClient::takeLine() {
    std::size_t end;
    while ((end = received_.find("\r\n", taken_)) == std::string::npos) {
        if (!fill()) return {};
    }
    std::string line = received_.substr(taken_, end - taken_);
    taken_ = end + 2;
    return line;
}

std::string WebClient::receiveAll() {
    while (fill()) {
    }
    return received_.substr(std::exchange(taken_, received_.size()));
}

WebClient::Answer WebClient::get(std::string_view target, std::string_view fields) {
    return request("GET " + std::string(target) + " HTTP/1.1\r\n", fields);
}

WebClient::Answer WebClient::request(std::string_view start, std::string_view fields) {
    std::string text(start);
    if (fields.find("Host:") == std::string_view::npos) text += "Host: localhost:" + std::to_string(port_) + "\r\n";
    send(text.append(fields).append("\r\n"));
    return receiveAnswer();
}

WebClient::Answer WebClient::receiveAnswer() {
    Answer answer;
    const auto first = takeLine();
    if (!first || first->size() < 12) return answer;
    for (auto line = takeLine(); line && !line->empty(); line = takeLine()) {
        const auto colon = line->find(": ");
        if (colon != std::string::npos) answer.fields[lowered(line->substr(0, colon))] = line->substr(colon + 2);
    }
    const auto length = answer.fields.find("content-length");
    if (length != answer.fields.end()) answer.body = take(std::stoul(length->second)).value_or("");
    answer.status = std::stoi(first->substr(9, 3));
    return answer;
}

int WebClient::open(std::string_view fields) {
    const Answer answer = get("/live",
                              "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                              "Sec-WebSocket-Key: " +
                                  std::string(kKey) + "\r\n" + std::string(fields));
    if (answer.status != 101) return answer.status;
    const auto accept = answer.fields.find("sec-websocket-accept");
    return accept != answer.fields.end() && accept->second == kAccept ? 101 : -1;
}

int WebClient::Frame::closeCode() const {
    if (opcode != kClose || payload.size() < 2) return 0;
    return static_cast<unsigned char>(payload[0]) << 8 | static_cast<unsigned char>(payload[1]);
}

std::string WebClient::frameHeader(int opcode, std::size_t size, bool last) {
    std::string header{static_cast<char>(opcode | (last ? 0x80 : 0))};
    const int bytes = size < 126 ? 0 : size < 65536 ? 2 : 8;
    header += static_cast<char>(0x80 | (bytes == 0 ? static_cast<int>(size) : bytes == 2 ? 126 : 127));
    for (int i = bytes - 1; i >= 0; --i) header += static_cast<char>(size >> (8 * i) & 0xff);
    return header.append(reinterpret_cast<const char*>(kMask), sizeof kMask);
}

bool WebClient::sendFrame(int opcode, std::string_view payload, bool last) {
    std::string frame = frameHeader(opcode, payload.size(), last);
    for (std::size_t i = 0; i < payload.size(); ++i) {
        frame += static_cast<char>(static_cast<unsigned char>(payload[i]) ^ kMask[i % 4]);
    }
    return send(frame);
}

std::optional<WebClient::Frame> WebClient::receive() {
    for (;;) {
        const auto start = take(2);
        if (!start) return {};
        std::size_t size = static_cast<unsigned char>((*start)[1]);
        if (size >= 126) {
            const auto more = take(size == 126 ? 2 : 8);
            if (!more) return {};
            size = 0;
            for (const char c : *more) size = size << 8 | static_cast<unsigned char>(c);
        }
        auto payload = take(size);
        if (!payload) return {};
        Frame frame{(*start)[0] & 0x0f, std::move(*payload)};
        if (frame.opcode != kPing) return frame;
        sendFrame(kPong, frame.payload);
    }
}

std::string WebClient::receiveTextWith(std::string_view part) {
    for (;;) {
        const auto frame = receive();
        if (!frame) return {};
        if (frame->opcode == kText && frame->payload.find(part) != std::string::npos) return frame->payload;
    }
}

}  // namespace ragtop
