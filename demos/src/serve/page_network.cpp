#include "page_network.h"

#include <fmt/format.h>
#include <signal.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "http_connection.h"
#include "page_socket.h"
#include "web_context.h"

namespace ragtop {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

/// How soon to look again for room for one more connection.
constexpr std::chrono::milliseconds kFullPause{50};
constexpr std::chrono::seconds kLagPeriod{1};

tcp::acceptor listenOn(asio::io_context& io, int port) {
    if (port < 0 || port > 65535) throw std::runtime_error(fmt::format("port {}: must be 0 to 65535", port));
    tcp::acceptor acceptor(io);
    error_code error;
    acceptor.open(tcp::v4(), error);
    if (!error) acceptor.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor.bind({asio::ip::address_v4::loopback(), static_cast<unsigned short>(port)}, error);
    if (!error) acceptor.non_blocking(true, error);
    if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error == asio::error::address_in_use) {
        throw std::runtime_error(fmt::format("port {} is taken: choose another one, or 0 for any free one", port));
    }
    if (error) throw std::runtime_error(fmt::format("cannot listen on port {}: {}", port, error.message()));
    return acceptor;
}

/// A thread to which no signal of the program is delivered.
std::thread quietThread(std::function<void()> body) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    std::thread thread(std::move(body));
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return thread;
}

}  // namespace

struct PageNetwork::Impl {
    Impl(const PageServerOptions& limits, const PageSite& site, Mailbox& mailbox)
        : options(limits),
          context{options, site, mailbox},
          io(1),
          acceptor(listenOn(io, options.port)),
          room(io),
          lagTimer(io) {
        context.port = acceptor.local_endpoint().port();
        accept();
        checkLag();
        thread = quietThread([this] { run(); });
    }
    ~Impl() {
        io.stop();
        thread.join();
    }

    /// What goes wrong with one connection, memory running out above all, ends that connection alone.
    void run() {
        for (;;) {
            try {
                io.run();
                return;
            } catch (const std::exception&) {
            }
        }
    }

    void accept() {
        acceptor.async_wait(tcp::acceptor::wait_read, [this](error_code error) { error ? acceptLater() : take(); });
    }

    /// For want of room, or of file descriptors.
    void acceptLater() {
        room.expires_after(kFullPause);
        room.async_wait([this](error_code) { accept(); });
    }

    /// Somebody asks for a connection. Where there is no room, it is made by who has longest not asked for anything.
    void take() {
        if (context.connections >= options.connections) {
            if (context.waiting.empty()) return acceptLater();
            const auto end = context.waiting.front();  // a copy, since it takes itself off the list
            end();
        }
        error_code error;
        tcp::socket socket = acceptor.accept(error);
        if (error) return acceptLater();
        Counted connection(context.connections);
        accept();
        socket.set_option(tcp::no_delay(true), error);
        serveHttp(boost::beast::tcp_stream(std::move(socket)), std::move(connection), context);
    }

    void checkLag() {
        for (auto at = context.sockets.begin(); at != context.sockets.end();) {
            const auto page = (at++)->second.lock();  // which takes itself off the map when it ends
            if (page) page->checkLag();
        }
        lagTimer.expires_after(kLagPeriod);
        lagTimer.async_wait([this](error_code) { checkLag(); });
    }

    void wake(ClientId client) {
        const auto at = context.sockets.find(client);
        if (at == context.sockets.end()) return;
        if (const auto page = at->second.lock()) page->wake();
    }

    const PageServerOptions options;
    WebContext context;  // outlives the handlers that io holds
    asio::io_context io;
    tcp::acceptor acceptor;
    asio::steady_timer room, lagTimer;
    std::thread thread;
};

PageNetwork::PageNetwork(const PageServerOptions& options, const PageSite& site, Mailbox& mailbox)
    : impl_(std::make_unique<Impl>(options, site, mailbox)) {}
PageNetwork::~PageNetwork() = default;

int PageNetwork::port() const { return impl_->context.port; }

void PageNetwork::wake(ClientId client) {
    asio::post(impl_->io, [impl = impl_.get(), client] { impl->wake(client); });
}

}  // namespace ragtop
