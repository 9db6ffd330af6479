#include "mailbox.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace ragtop {

using Kind = PageServer::MessageKind;

namespace {

/// With so many unanswered, one more would tell nothing new.
constexpr std::size_t kPingsInFlight = 64;

}  // namespace

bool Mailbox::receive(PageServer::Message& into) {
    const std::lock_guard lock(mutex_);
    if (inbox_.empty()) return false;
    into = std::move(inbox_.front());
    inbox_.pop_front();
    inboxBytes_ -= into.text.size();
    if (into.kind == Kind::joined) known_.push_back(into.client);
    if (into.kind == Kind::left) std::erase(known_, into.client);
    const auto from = connected_.find(into.client);
    if (into.kind == Kind::said && from != connected_.end()) --from->second.unread;
    return true;
}

bool Mailbox::wait(double seconds) {
    std::unique_lock lock(mutex_);
    return arrived_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return !inbox_.empty(); });
}

std::vector<ClientId> Mailbox::clients() const {
    const std::lock_guard lock(mutex_);
    return known_;
}

bool Mailbox::ready(ClientId client) const {
    const std::lock_guard lock(mutex_);
    const auto at = connected_.find(client);
    return at != connected_.end() && !at->second.overflown && at->second.unsentFrames == 0 &&
           lag(at->second) <= limits_.lagSeconds;
}

bool Mailbox::send(ClientId client, Outgoing item) {
    const std::lock_guard lock(mutex_);
    const auto at = connected_.find(client);
    if (at == connected_.end() || at->second.overflown) return false;
    Client& to = at->second;
    to.unsentBytes += item.bytes();
    to.unsentFrames += item.kind == Outgoing::Kind::frame;
    to.queue.push_back(std::move(item));
    if (to.unsentBytes > limits_.unsentBytes) {
        to.overflown = true;
        to.queue.clear();
        return true;
    }
    return !std::exchange(to.busy, true);
}

bool Mailbox::hasRoom() const {
    const std::lock_guard lock(mutex_);
    return !full();
}

ClientId Mailbox::join() {
    const std::lock_guard lock(mutex_);
    connected_.try_emplace(++last_);
    push(last_, Kind::joined, {});
    return last_;
}

void Mailbox::leave(ClientId client) {
    const std::lock_guard lock(mutex_);
    connected_.erase(client);
    push(client, Kind::left, {});
}

bool Mailbox::say(ClientId client, std::string text) {
    const std::lock_guard lock(mutex_);
    Client& from = connected_.at(client);
    if (from.unread >= limits_.unreadMessages || full() || inboxBytes_ + text.size() > limits_.unreadBytes)
        return false;
    ++from.unread;
    push(client, Kind::said, std::move(text));
    return true;
}

void Mailbox::push(ClientId client, Kind kind, std::string text) {
    inboxBytes_ += text.size();
    inbox_.push_back({client, kind, std::move(text)});
    arrived_.notify_one();
}

std::optional<Outgoing> Mailbox::next(ClientId client) {
    const std::lock_guard lock(mutex_);
    Client& to = connected_.at(client);
    settle(to);
    if (to.queue.empty()) {
        if (!to.pingDue || to.asked.size() >= kPingsInFlight) {
            to.busy = false;
            return {};
        }
        to.pingDue = false;
        to.asked.push_back(Clock::now());
        const auto number = to.answered + static_cast<std::uint32_t>(to.asked.size());
        return Outgoing{.kind = Outgoing::Kind::ping, .text = {}, .frame = {}, .ping = number};
    }
    Outgoing item = std::move(to.queue.front());
    to.queue.pop_front();
    to.pingDue = true;
    to.leavingBytes = item.bytes();
    to.leavingFrames = item.kind == Outgoing::Kind::frame;
    to.leavingSince = Clock::now();
    return item;
}

/// The item under way has left.
void Mailbox::settle(Client& client) {
    client.unsentBytes -= std::exchange(client.leavingBytes, 0);
    client.unsentFrames -= std::exchange(client.leavingFrames, 0);
}

void Mailbox::answered(ClientId client, std::uint32_t ping) {
    const std::lock_guard lock(mutex_);
    Client& from = connected_.at(client);
    const std::size_t count = ping - from.answered;
    if (count > from.asked.size()) return;
    from.asked.erase(from.asked.begin(), from.asked.begin() + static_cast<std::ptrdiff_t>(count));
    from.answered = ping;
}

bool Mailbox::overflown(ClientId client) const {
    const std::lock_guard lock(mutex_);
    return connected_.at(client).overflown;
}

double Mailbox::lag(ClientId client) const {
    const std::lock_guard lock(mutex_);
    return lag(connected_.at(client));
}

double Mailbox::lag(const Client& client) {
    const Clock::time_point now = Clock::now();
    Clock::time_point since = now;
    if (!client.asked.empty()) since = client.asked.front();
    if (client.leavingBytes > 0) since = std::min(since, client.leavingSince);
    return std::chrono::duration<double>(now - since).count();
}

}  // namespace ragtop
