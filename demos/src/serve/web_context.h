#pragma once

#include <cstddef>
#include <functional>
#include <list>
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

/// Connections that wait for a request, each by the function that ends it; the longest wait comes first.
using Waiting = std::list<std::function<void()>>;

/// A place among those for as long as it lives.
class WaitingPlace {
public:
    WaitingPlace(Waiting& waiting, std::function<void()> end)
        : waiting_(waiting), at_(waiting.insert(waiting.end(), std::move(end))) {}
    WaitingPlace(const WaitingPlace&) = delete;
    WaitingPlace& operator=(const WaitingPlace&) = delete;
    ~WaitingPlace() { waiting_.erase(at_); }

private:
    Waiting& waiting_;
    const Waiting::iterator at_;
};

/// What the connections of a server share. It belongs to the network's thread.
struct WebContext {
    const PageServerOptions& options;
    const PageSite& site;
    Mailbox& mailbox;
    int port = 0;
    std::size_t connections = 0, pages = 0;                   ///< open now
    Waiting waiting{};
    std::map<ClientId, std::weak_ptr<PageSocket>> sockets{};  ///< of the pages that have joined
};

}  // namespace ragtop
