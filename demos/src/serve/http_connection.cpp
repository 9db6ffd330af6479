#include "http_connection.h"

#include <array>
#include <boost/beast/core/flat_static_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/span_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "mailbox.h"
#include "page_site.h"
#include "page_socket.h"

namespace ragtop {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using beast::error_code;

namespace {

constexpr std::uint32_t kHeaderBytes = 8192;
/// How long a refused connection is still read from, so that its sender gets to read why.
constexpr std::chrono::seconds kLinger{1};

/// Only headers are read.
using Parser = http::request_parser<http::empty_body>;

std::vector<std::string> valuesOf(const Parser::value_type& request, http::field name) {
    std::vector<std::string> values;
    const auto [begin, end] = request.equal_range(name);
    for (auto field = begin; field != end; ++field) values.emplace_back(field->value());
    return values;
}

WebRequest describe(const Parser& parser) {
    const auto& request = parser.get();
    return {.method = std::string(request.method_string()),
            .target = std::string(request.target()),
            .hosts = valuesOf(request, http::field::host),
            .origins = valuesOf(request, http::field::origin),
            .upgrade = beast::websocket::is_upgrade(request),
            .body = parser.chunked() || parser.content_length().value_or(0) > 0};
}

class HttpConnection : public std::enable_shared_from_this<HttpConnection> {
public:
    HttpConnection(beast::tcp_stream&& stream, Counted connection, WebContext& context)
        : stream_(std::move(stream)), connection_(std::move(connection)), context_(context) {}

    void read() {
        parser_.emplace();
        parser_->header_limit(kHeaderBytes);
        parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // Boost 1.74 takes "none" for 0
        allowSeconds(context_.options.requestSeconds);
        waiting_.emplace(context_.waiting, [this] {
            waiting_.reset();
            stream_.close();
        });
        http::async_read_header(stream_, incoming_, *parser_,
                                [self = shared_from_this()](error_code error, std::size_t) { self->onRead(error); });
    }

private:
    void onRead(error_code error) {
        waiting_.reset();
        if (error == http::error::header_limit || error == http::error::buffer_overflow) {
            return write(textAnswer(431, "The request is too long"), false);
        }
        if (error == http::error::end_of_stream || error == http::error::partial_message) return;
        if (error && error.category() == make_error_code(http::error::bad_method).category()) {
            return write(textAnswer(400, "The request is not HTTP"), false);
        }
        if (error) return;
        const WebAnswer answer = context_.site.answer(describe(*parser_), context_.port);
        if (answer.status == 101) return upgrade();
        write(answer, parser_->get().keep_alive() && answer.status == 200);
    }

    void upgrade() {
        if (context_.pages >= context_.options.clients || !context_.mailbox.hasRoom()) {
            return write(textAnswer(503, "Too many pages are open"), false);
        }
        if (incoming_.size() > 0) return write(textAnswer(400, "Nothing may follow before the answer"), false);
        const auto socket = std::make_shared<PageSocket>(std::move(stream_), std::move(connection_), context_);
        socket->start(parser_->get());
    }

    void write(const WebAnswer& answer, bool keepAlive) {
        body_ = answer.body;
        response_ = {};
        response_.version(11);
        response_.result(static_cast<unsigned>(answer.status));
        response_.set(http::field::content_type, answer.mime);
        for (const auto& [name, value] : protectiveFields(context_.port)) response_.set(name, value);
        if (answer.status == 405) response_.set(http::field::allow, "GET");
        if (answer.status == 426) response_.set(http::field::upgrade, "websocket");
        response_.keep_alive(keepAlive);
        response_.body() = {body_->data(), body_->size()};
        response_.prepare_payload();
        allowSeconds(context_.options.requestSeconds);
        http::async_write(stream_, response_, [self = shared_from_this(), keepAlive](error_code error, std::size_t) {
            if (error) return;
            keepAlive ? self->read() : self->linger();
        });
    }

    /// Closing at once would reset the connection while the other side still writes, and take the answer with it.
    void linger() {
        error_code ignored;
        stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
        stream_.expires_after(kLinger);
        drain();
    }

    void drain() {
        stream_.async_read_some(asio::buffer(drained_), [self = shared_from_this()](error_code error, std::size_t) {
            if (!error) self->drain();
        });
    }

    void allowSeconds(double seconds) {
        stream_.expires_after(
            std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::duration<double>(seconds)));
    }

    beast::tcp_stream stream_;
    Counted connection_;
    WebContext& context_;
    beast::flat_static_buffer<kHeaderBytes> incoming_;
    std::optional<Parser> parser_;
    std::shared_ptr<const std::vector<std::byte>> body_;
    http::response<http::span_body<const std::byte>> response_;
    std::array<char, 4096> drained_;
    std::optional<WaitingPlace> waiting_;
};

}  // namespace

void serveHttp(beast::tcp_stream&& stream, Counted connection, WebContext& context) {
    std::make_shared<HttpConnection>(std::move(stream), std::move(connection), context)->read();
}

}  // namespace ragtop
