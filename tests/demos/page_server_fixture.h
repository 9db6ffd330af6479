#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "serve/page_server.h"
#include "web_client.h"

namespace ragtop {

/// A limit that only a failing test reaches.
constexpr double kForever = 60;

/// The next message, which must come.
inline PageServer::Message nextMessage(PageServer& server) {
    PageServer::Message message;
    EXPECT_TRUE(server.wait(kForever));
    EXPECT_TRUE(server.receive(message));
    return message;
}

/// Lets a client join.
inline ClientId openedBy(WebClient& client, PageServer& server) {
    EXPECT_EQ(client.open(), 101);
    const PageServer::Message message = nextMessage(server);
    EXPECT_EQ(message.kind, PageServer::MessageKind::joined);
    return message.client;
}

inline PageServerOptions onAnyPort(PageServerOptions options = {}) {
    options.port = 0;
    return options;
}

inline FrameBytes frameOf(std::size_t bytes, std::byte value = {}) {
    return std::make_shared<const std::vector<std::byte>>(bytes, value);
}

}  // namespace ragtop
