#include "page_site.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace ragtop {

namespace {

constexpr std::string_view kHtml = "text/html; charset=utf-8";
constexpr std::string_view kNoPage =
    "<!doctype html><title>Ragtop</title><p>The simulation runs, but the page that shows it has not been built. Build "
    "it with <code>scripts/page.sh build</code>, then start this program again.\n";

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool equalsIgnoringCase(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

/// Whether it names this machine's own address and the port; a page of any other host, even of one whose name has been
/// made to resolve to 127.0.0.1, is none of ours.
bool isOwnHost(std::string_view host, int port) {
    return std::ranges::any_of(std::to_array<std::string_view>({"127.0.0.1", "localhost"}), [&](auto name) {
        return equalsIgnoringCase(host, fmt::format("{}:{}", name, port)) ||
               (port == 80 && equalsIgnoringCase(host, name));
    });
}

bool isOwnOrigin(std::string_view origin, int port) {
    constexpr std::string_view scheme = "http://";
    return origin.starts_with(scheme) && isOwnHost(origin.substr(scheme.size()), port);
}

bool isNameCharacter(char c) {
    return (lower(c) >= 'a' && lower(c) <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '_' || c == '-';
}

template <class Range>
std::shared_ptr<const std::vector<std::byte>> bytesOf(const Range& text) {
    auto bytes = std::make_shared<std::vector<std::byte>>();
    std::ranges::transform(text, std::back_inserter(*bytes), [](char c) { return static_cast<std::byte>(c); });
    return bytes;
}

std::string readPage(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(file), {}};
    if (!file || text.empty()) throw std::runtime_error(fmt::format("{}: cannot read the page", path.string()));
    return text;
}

}  // namespace

WebAnswer textAnswer(int status, std::string_view text) {
    WebAnswer answer;
    answer.status = status;
    answer.body = bytesOf(fmt::format("{}\n", text));
    return answer;
}

PageSite::PageSite(const std::filesystem::path& page, std::size_t publishedBytes) : bytesAllowed_(publishedBytes) {
    files_["/"] = {200, std::string{kHtml}, page.empty() ? bytesOf(kNoPage) : bytesOf(readPage(page))};
}

void PageSite::publish(const std::string& name, const std::string& mime, std::vector<std::byte> bytes) {
    if (name.empty() || !std::ranges::all_of(name, isNameCharacter)) {
        throw std::invalid_argument(
            fmt::format("published name \"{}\": must be of letters, digits, '.', '_' and '-'", name));
    }
    if (mime.empty() || !std::ranges::all_of(mime, [](char c) { return c >= ' ' && c <= '~'; })) {
        throw std::invalid_argument(fmt::format("media type of \"{}\": must be printable ASCII", name));
    }
    if (bytes.size() > bytesAllowed_) {
        throw std::invalid_argument(
            fmt::format("\"{}\" has {} bytes: must be at most {}", name, bytes.size(), bytesAllowed_));
    }
    const std::lock_guard lock(mutex_);
    const std::string path = "/visual/" + name;
    forget(path);
    while (bytes_ + bytes.size() > bytesAllowed_) forget(std::string(published_.front()));
    bytes_ += bytes.size();
    published_.push_back(path);
    files_[path] = {200, mime, std::make_shared<const std::vector<std::byte>>(std::move(bytes))};
}

void PageSite::forget(const std::string& path) {
    const auto file = files_.find(path);
    if (file == files_.end()) return;
    bytes_ -= file->second.body->size();
    files_.erase(file);
    std::erase(published_, path);
}

WebAnswer PageSite::answer(const WebRequest& request, int port) const {
    if (request.hosts.size() != 1 || !isOwnHost(request.hosts[0], port)) {
        return textAnswer(403, fmt::format("The host must be localhost:{}", port));
    }
    if (request.origins.size() > 1 || (request.origins.size() == 1 && !isOwnOrigin(request.origins[0], port))) {
        return textAnswer(403, fmt::format("The origin must be http://localhost:{}", port));
    }
    if (request.method != "GET") return textAnswer(405, "Only GET is answered");
    if (request.body) return textAnswer(413, "A request must have no body");
    const std::string_view path = std::string_view{request.target}.substr(0, request.target.find('?'));
    if (path != "/live") return found(path);
    if (!request.upgrade) return textAnswer(426, "Only WebSocket connections are answered here");
    return {.status = 101, .mime = {}, .body = {}};
}

WebAnswer PageSite::found(std::string_view path) const {
    const std::lock_guard lock(mutex_);
    const auto file = files_.find(path);
    return file == files_.end() ? textAnswer(404, "There is nothing of this name") : file->second;
}

std::vector<std::pair<std::string, std::string>> protectiveFields(int port) {
    // To some browsers 'self' means http alone, so the WebSocket needs naming.
    constexpr std::string_view policy =
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src blob: data:; "
        "font-src data:; worker-src blob:; "
        "connect-src 'self' blob: data: ws://127.0.0.1:{0} ws://localhost:{0}; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
    return {
        {"Content-Security-Policy", fmt::format(policy, port)},
        {"X-Content-Type-Options", "nosniff"},
        {"X-Frame-Options", "DENY"},
        {"Referrer-Policy", "no-referrer"},
        {"Cross-Origin-Resource-Policy", "same-origin"},
        {"Cross-Origin-Opener-Policy", "same-origin"},
        {"Cache-Control", "no-store"},
    };
}

}  // namespace ragtop
