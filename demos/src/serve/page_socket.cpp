#include "page_socket.h"

#include <fmt/format.h>

#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <charconv>
#include <chrono>

namespace ragtop {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

/// A page that sends more than may wait is read from only this often, so that it cannot keep the machine busy.
constexpr std::chrono::milliseconds kFloodPause{10};

/// 0, which no ping has, when it is no number.
std::uint32_t pingNumber(beast::string_view payload) {
    std::uint32_t number = 0;
    std::from_chars(payload.data(), payload.data() + payload.size(), number);
    return number;
}

}  // namespace

PageSocket::PageSocket(beast::tcp_stream&& stream, Counted connection, WebContext& context)
    : stream_(std::move(stream)),
      pause_(stream_.get_executor()),
      connection_(std::move(connection)),
      page_(context.pages),
      limits_(context.options),
      mailbox_(context.mailbox),
      registry_(context.sockets) {}

PageSocket::~PageSocket() {
    if (!client_) return;
    registry_.erase(client_);
    mailbox_.leave(client_);
}

void PageSocket::start(const Request& request) {
    beast::get_lowest_layer(stream_).expires_never();
    // It serves for closing too. Silence is this class's own affair.
    const auto handshake =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(limits_.requestSeconds));
    stream_.set_option(websocket::stream_base::timeout{handshake, websocket::stream_base::none(), false});
    stream_.read_message_max(limits_.messageBytes);
    stream_.auto_fragment(false);
    stream_.control_callback([this](websocket::frame_type type, beast::string_view payload) {
        if (type == websocket::frame_type::pong) mailbox_.answered(client_, pingNumber(payload));
    });
    stream_.async_accept(request, [self = shared_from_this()](Error error) {
        if (!error) self->joined();
    });
}

void PageSocket::joined() {
    client_ = mailbox_.join();
    registry_[client_] = weak_from_this();
    read();
}

void PageSocket::read() {
    stream_.async_read(incoming_, [self = shared_from_this()](Error error, std::size_t) { self->onRead(error); });
}

void PageSocket::onRead(Error error) {
    if (error) return cut();
    std::string message = beast::buffers_to_string(incoming_.data());
    incoming_.consume(incoming_.size());
    if (!stream_.got_text()) {
        refuse("a message must be text: a JSON object");
    } else if (!mailbox_.say(client_, std::move(message))) {
        refuse("too many messages wait, this one was dropped");
    } else {
        return read();
    }
    pause_.expires_after(kFloodPause);
    pause_.async_wait([self = shared_from_this()](Error) { self->read(); });
}

void PageSocket::refuse(std::string_view why) {
    std::string text = fmt::format(R"({{"type":"error","error":"{}"}})", why);
    if (mailbox_.send(client_, {.kind = Outgoing::Kind::text, .text = std::move(text), .frame = {}})) wake();
}

void PageSocket::wake() {
    if (mailbox_.overflown(client_)) return cut();
    if (!sending_) sendNext();
}

void PageSocket::sendNext() {
    std::optional<Outgoing> next = mailbox_.next(client_);
    sending_ = next.has_value();
    if (!sending_) return;
    outgoing_ = std::move(*next);
    const auto sent = [self = shared_from_this()](Error error, std::size_t = 0) { self->onSent(error); };
    switch (outgoing_.kind) {
        case Outgoing::Kind::text:
            stream_.text(true);
            return stream_.async_write(asio::const_buffer(asio::buffer(outgoing_.text)), sent);
        case Outgoing::Kind::frame:
            stream_.binary(true);
            return stream_.async_write(asio::const_buffer(asio::buffer(*outgoing_.frame)), sent);
        case Outgoing::Kind::ping: {
            const std::string number = std::to_string(outgoing_.ping);
            return stream_.async_ping(websocket::ping_data(number.data(), number.size()), sent);
        }
    }
}

void PageSocket::onSent(Error error) {
    outgoing_ = {};
    // The connection is about to end, perhaps with a close frame under way; the read that is pending will tell.
    if (error) return;
    sendNext();
}

void PageSocket::checkLag() {
    if (mailbox_.lag(client_) > limits_.silenceSeconds) cut();
}

/// What is under way fails then, so that nothing keeps this alive.
void PageSocket::cut() {
    beast::get_lowest_layer(stream_).close();
    pause_.cancel();
}

}  // namespace ragtop
