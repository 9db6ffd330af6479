#pragma once

#include <boost/beast/core/tcp_stream.hpp>

#include "web_context.h"

namespace ragtop {

/// Answers the requests that come in on a connection, until it ends, is idle for too long, or becomes a WebSocket.
void serveHttp(boost::beast::tcp_stream&& stream, Counted connection, WebContext& context);

}  // namespace ragtop
