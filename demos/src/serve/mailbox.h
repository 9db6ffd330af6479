#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "page_server.h"

namespace ragtop {

/// What goes to a page in one piece.
struct Outgoing {
    enum class Kind : std::uint8_t { text, frame, ping };
    Kind kind = Kind::text;
    std::string text;
    FrameBytes frame;
    std::uint32_t ping = 0;  ///< number of the ping, from 1

    std::size_t bytes() const { return frame ? frame->size() : text.size(); }
};

/// Messages on their way between the thread that simulates and the thread that does the network, with the limits of
/// PageServerOptions. All functions may be called from both.
///
/// How far a page has read is known from its answers to pings, which every WebSocket client gives by itself in the
/// order in which it reads: a ping follows whenever all that was queued has left.
class Mailbox {
public:
    explicit Mailbox(const PageServerOptions& limits) : limits_(limits) {}

    bool receive(PageServer::Message& into);
    bool wait(double seconds);
    std::vector<ClientId> clients() const;
    bool ready(ClientId client) const;

    /// True when the network has nothing under way for this client, so that it must be told.
    [[nodiscard]] bool send(ClientId client, Outgoing item);

    /// Whether there is room for the messages of one more client.
    bool hasRoom() const;
    ClientId join();
    void leave(ClientId client);
    /// False: more than the limits would wait.
    [[nodiscard]] bool say(ClientId client, std::string text);

    /// What to send next; call it when told to, and each time the item before has left.
    std::optional<Outgoing> next(ClientId client);
    /// The client has answered this ping, and so has read all that was sent before.
    void answered(ClientId client, std::uint32_t ping);
    /// More than the limit is unsent; nothing will be any more.
    bool overflown(ClientId client) const;
    /// How long ago something was sent that the client has still not read, s.
    double lag(ClientId client) const;

private:
    using Clock = std::chrono::steady_clock;

    struct Client {
        std::size_t unread = 0;  // messages from it
        std::deque<Outgoing> queue;
        std::size_t unsentBytes = 0, unsentFrames = 0;    // queued and under way
        std::size_t leavingBytes = 0, leavingFrames = 0;  // of the item under way
        Clock::time_point leavingSince;
        bool busy = false;     // an item is under way, or the network is about to ask for one
        bool pingDue = false;  // something has left since the last ping
        bool overflown = false;
        std::uint32_t answered = 0;           // number of the last ping that was
        std::deque<Clock::time_point> asked;  // when those after it were sent
    };
    bool full() const { return inbox_.size() >= limits_.clients * limits_.unreadMessages; }
    void push(ClientId client, PageServer::MessageKind kind, std::string text);
    static void settle(Client& client);
    static double lag(const Client& client);

    const PageServerOptions limits_;
    mutable std::mutex mutex_;
    std::condition_variable arrived_;
    std::deque<PageServer::Message> inbox_;
    std::size_t inboxBytes_ = 0;
    std::map<ClientId, Client> connected_;
    std::vector<ClientId> known_;  // by the messages received so far
    ClientId last_ = 0;
};

}  // namespace ragtop
