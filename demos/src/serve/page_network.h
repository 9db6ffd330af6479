#pragma once

#include <memory>

#include "mailbox.h"
#include "page_server.h"
#include "page_site.h"

namespace ragtop {

/// The sockets of a PageServer, and the thread that serves them.
class PageNetwork {
public:
    /// Both must outlive it. Throws std::runtime_error when it cannot listen.
    PageNetwork(const PageServerOptions& options, const PageSite& site, Mailbox& mailbox);
    ~PageNetwork();

    int port() const;
    /// Something waits for this client.
    void wake(ClientId client);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace ragtop
