#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <utility>

#include "page_server.h"

namespace ragtop {

class Mailbox;
class PageSite;
class PageSocket;

/// Counts something for as long as it lives.
class Counted {
public:
    explicit Counted(std::size_t& count) : count_(&count) { ++*count_; }
    Counted(Counted&& other) noexcept : count_(std::exchange(other.count_, nullptr)) {}
    Counted& operator=(Counted&&) = delete;
    ~Counted() {
        if (count_) --*count_;
    }

private:
    std::size_t* count_;
};

/// What the connections of a server share. It belongs to the network's thread.
struct WebContext {
    const PageServerOptions& options;
    const PageSite& site;
    Mailbox& mailbox;
    int port = 0;
    std::size_t connections = 0, pages = 0;                   ///< open now
    std::map<ClientId, std::weak_ptr<PageSocket>> sockets{};  ///< of the pages that have joined
};

}  // namespace ragtop
