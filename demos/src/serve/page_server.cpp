#include "page_server.h"

#include <utility>

#include "mailbox.h"
#include "page_network.h"
#include "page_site.h"

namespace ragtop {

struct PageServer::Impl {
    explicit Impl(const PageServerOptions& options)
        : site(options.page, options.publishedBytes), mailbox(options), network(options, site, mailbox) {}

    void send(ClientId client, Outgoing item) {
        if (mailbox.send(client, std::move(item))) network.wake(client);
    }

    PageSite site;
    Mailbox mailbox;
    PageNetwork network;
};

PageServer::PageServer(const PageServerOptions& options) : impl_(std::make_unique<Impl>(options)) {}
PageServer::~PageServer() = default;

int PageServer::port() const { return impl_->network.port(); }
bool PageServer::receive(Message& into) { return impl_->mailbox.receive(into); }
bool PageServer::wait(double seconds) { return impl_->mailbox.wait(seconds); }
std::vector<ClientId> PageServer::clients() const { return impl_->mailbox.clients(); }
bool PageServer::ready(ClientId client) const { return impl_->mailbox.ready(client); }

void PageServer::send(ClientId client, std::string text) {
    impl_->send(client, {.kind = Outgoing::Kind::text, .text = std::move(text), .frame = {}});
}

void PageServer::sendFrame(ClientId client, FrameBytes frame) {
    impl_->send(client, {.kind = Outgoing::Kind::frame, .text = {}, .frame = std::move(frame)});
}

void PageServer::publish(const std::string& name, const std::string& mime, std::vector<std::byte> bytes) {
    impl_->site.publish(name, mime, std::move(bytes));
}

}  // namespace ragtop
