#pragma once

#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <map>
#include <memory>
#include <string_view>

#include "mailbox.h"
#include "web_context.h"

namespace ragtop {

/// The connection to one page, as a WebSocket. It lives while it waits for something of the network, in whose thread
/// all its functions are called.
class PageSocket : public std::enable_shared_from_this<PageSocket> {
public:
    using Request = boost::beast::http::request<boost::beast::http::empty_body>;

    PageSocket(boost::beast::tcp_stream&& stream, Counted connection, WebContext& context);
    /// The page has left.
    ~PageSocket();

    /// Completes the handshake that the request began.
    void start(const Request& request);
    /// Something waits to be sent, or too much does. For pages that have joined, as is the next.
    void wake();
    /// Cuts off a page that has long ceased to read.
    void checkLag();

private:
    using Error = boost::beast::error_code;

    void joined();
    void read();
    void onRead(Error error);
    void refuse(std::string_view why);
    void sendNext();
    void onSent(Error error);
    void cut();

    /// Nothing is compressed: frames are packed already, and what would do it takes long to compile.
    boost::beast::websocket::stream<boost::beast::tcp_stream, false> stream_;
    boost::asio::steady_timer pause_;
    const Counted connection_, page_;
    const PageServerOptions& limits_;
    Mailbox& mailbox_;
    std::map<ClientId, std::weak_ptr<PageSocket>>& registry_;
    ClientId client_ = 0;  // 0 while not joined
    boost::beast::flat_buffer incoming_;
    Outgoing outgoing_;
    bool sending_ = false;
};

}  // namespace ragtop
