#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ragtop {

/// What of an HTTP request decides its answer.
struct WebRequest {
    std::string method, target;
    std::vector<std::string> hosts, origins;  ///< the values of all such fields
    bool upgrade = false;                     ///< asks for a WebSocket
    bool body = false;
};

struct WebAnswer {
    int status = 200;  ///< 101: go on as a WebSocket
    std::string mime = "text/plain; charset=utf-8";
    std::shared_ptr<const std::vector<std::byte>> body;
};

/// The page and the files published beside it, all in memory: a request is looked up by its exact name, so that nothing
/// else can be reached. All functions may be called from any thread.
class PageSite {
public:
    /// Reads the page; empty: a text that tells how to build it. Throws std::runtime_error when it cannot.
    PageSite(const std::filesystem::path& page, std::size_t publishedBytes);

    /// See PageServer::publish.
    void publish(const std::string& name, const std::string& mime, std::vector<std::byte> bytes);
    /// The answer of the server that listens on this port.
    WebAnswer answer(const WebRequest& request, int port) const;

private:
    WebAnswer found(std::string_view path) const;

    void forget(const std::string& path);

    mutable std::mutex mutex_;
    std::map<std::string, WebAnswer, std::less<>> files_;  // by path
    std::deque<std::string> published_;                    // paths in the order of publishing
    const std::size_t bytesAllowed_;
    std::size_t bytes_ = 0;
};

/// A one-line answer for people.
WebAnswer textAnswer(int status, std::string_view text);

/// The fields that every answer carries: the page may run and draw what it has inside and talk to this server, and
/// nothing else; other sites may neither frame it nor use its files.
std::vector<std::pair<std::string, std::string>> protectiveFields(int port);

}  // namespace ragtop
