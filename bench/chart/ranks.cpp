#include "ranks.h"

#include <cstdlib>
#include <stdexcept>

#ifdef RAGTOP_WITH_MPI
#include <mpi.h>
#include <time.h>

#include <cstring>
#include <vector>
#endif

namespace ragtop::chart {
namespace {

/// As Open MPI's mpirun tells its processes.
int startedByMpirun() {
    const char* count = std::getenv("OMPI_COMM_WORLD_SIZE");
    return count ? std::atoi(count) : 1;
}

#ifdef RAGTOP_WITH_MPI

constexpr int kTag = 1;
constexpr long kDismissed = -1;

/// MPI's own waiting turns round and round, on a processor that others measure on.
MPI_Status await(int source) {
    for (;;) {
        int there = 0;
        MPI_Status status;
        MPI_Iprobe(source, kTag, MPI_COMM_WORLD, &there, &status);
        if (there) return status;
        const timespec pause{0, 2'000'000};
        ::nanosleep(&pause, nullptr);
    }
}

void send(int to, long number) { MPI_Send(&number, 1, MPI_LONG, to, kTag, MPI_COMM_WORLD); }

/// Seconds, the length of what the work returned, that, and its death.
std::string packed(const stability::Outcome& outcome) {
    const std::size_t length = outcome.text.size();
    std::string bytes(sizeof outcome.seconds + sizeof length, '\0');
    std::memcpy(bytes.data(), &outcome.seconds, sizeof outcome.seconds);
    std::memcpy(bytes.data() + sizeof outcome.seconds, &length, sizeof length);
    return bytes + outcome.text + outcome.death;
}

stability::Outcome unpacked(const std::string& bytes) {
    stability::Outcome outcome;
    std::size_t length = 0;
    std::memcpy(&outcome.seconds, bytes.data(), sizeof outcome.seconds);
    std::memcpy(&length, bytes.data() + sizeof outcome.seconds, sizeof length);
    constexpr std::size_t kHead = sizeof outcome.seconds + sizeof length;
    outcome.text = bytes.substr(kHead, length);
    outcome.death = bytes.substr(kHead + length);
    return outcome;
}

#endif

}  // namespace

#ifdef RAGTOP_WITH_MPI

Ranks::Ranks() {
    if (startedByMpirun() <= 1) return;
    MPI_Init(nullptr, nullptr);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
}

Ranks::~Ranks() {
    if (count_ > 1) MPI_Finalize();
}

void Ranks::handOut(std::span<const std::size_t> numbers, const Done& done) const {
    std::size_t next = 0, open = 0;
    std::vector<std::size_t> doing(static_cast<std::size_t>(count_));
    const auto give = [&](int rank) {
        if (next == numbers.size()) return;
        doing[static_cast<std::size_t>(rank)] = numbers[next++];
        send(rank, static_cast<long>(doing[static_cast<std::size_t>(rank)]));
        ++open;
    };
    for (int rank = 1; rank < count_; ++rank) give(rank);
    while (open > 0) {
        const MPI_Status status = await(MPI_ANY_SOURCE);
        int size = 0;
        MPI_Get_count(&status, MPI_CHAR, &size);
        std::string bytes(static_cast<std::size_t>(size), '\0');
        const int rank = status.MPI_SOURCE;
        MPI_Recv(bytes.data(), size, MPI_CHAR, rank, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        --open;
        const std::size_t number = doing[static_cast<std::size_t>(rank)];
        give(rank);
        done(number, unpacked(bytes));
    }
}

void Ranks::dismiss() const {
    for (int rank = 1; rank < count_; ++rank) send(rank, kDismissed);
}

void Ranks::serve(const Work& work, double limit) const {
    for (;;) {
        await(0);
        long number = kDismissed;
        MPI_Recv(&number, 1, MPI_LONG, 0, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        if (number == kDismissed) return;
        const auto report = [](std::size_t, const stability::Outcome& outcome) {
            const std::string bytes = packed(outcome);
            MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_CHAR, 0, kTag, MPI_COMM_WORLD);
        };
        stability::runIsolated({[&] { return work(static_cast<std::size_t>(number)); }}, 1, report, limit);
    }
}

#else

Ranks::Ranks() {
    if (startedByMpirun() > 1)
        throw std::runtime_error("mpirun: this program was built without Open MPI (libopenmpi-dev)");
}
Ranks::~Ranks() = default;
void Ranks::handOut(std::span<const std::size_t>, const Done&) const {}
void Ranks::dismiss() const {}
void Ranks::serve(const Work&, double) const {}

#endif

}  // namespace ragtop::chart
