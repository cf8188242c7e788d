#include "precompute/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "precompute/base/error.h"

namespace prt {
namespace fs = std::filesystem;
namespace {

// NAME.prt-tmp-PID-COUNT: the process id tells a stale temporary from one that is being written.
constexpr std::string_view kMarker = ".prt-tmp-";
std::atomic<int> gCounter{0};

std::string systemMessage() { return std::generic_category().message(errno); }

}  // namespace

AtomicFile::AtomicFile(fs::path destination) : destination_(std::move(destination)) {
    std::error_code ignored;
    // Through links: it is the file they point to that is replaced.
    if (fs::is_symlink(destination_, ignored)) destination_ = fs::weakly_canonical(destination_, ignored);
    const fs::file_status status = fs::status(destination_, ignored);
    if (fs::is_directory(status)) throw OutputError(destination_.string(), "is a directory", "name a file");
    // Renaming over a device would replace it, /dev/null included.
    if (fs::exists(status) && !fs::is_regular_file(status))
        throw OutputError(destination_.string(), "is a device or pipe", "name a file");
    temporary_ = destination_;
    temporary_ += fmt::format("{}{}-{}", kMarker, ::getpid(), gCounter++);
    const int file = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0)
        throw OutputError(destination_.string(), "cannot be written: " + systemMessage(),
                          "check that the directory exists and is writable");
    ::close(file);
}

AtomicFile::~AtomicFile() {
    if (committed_) return;
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

void AtomicFile::commit() {
    const int file = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
    const bool flushed = file >= 0 && ::fsync(file) == 0;
    const std::string problem = flushed ? "" : systemMessage();
    if (file >= 0) ::close(file);
    if (!flushed) throw OutputError(destination_.string(), "cannot be flushed: " + problem);
    if (::rename(temporary_.c_str(), destination_.c_str()) != 0)
        throw OutputError(destination_.string(), "cannot be renamed into place: " + systemMessage());
    committed_ = true;
}

void writeFileAtomically(const fs::path& destination, std::span<const std::byte> bytes) {
    AtomicFile atomic(destination);
    std::FILE* file = std::fopen(atomic.temporaryPath().c_str(), "wb");
    if (!file) throw OutputError(destination.string(), "cannot be written: " + systemMessage());
    const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    const bool closed = std::fclose(file) == 0;
    if (!written || !closed)
        throw OutputError(destination.string(), "cannot be written: " + systemMessage(), "is the disk full?");
    atomic.commit();
}

void writeFileAtomically(const fs::path& destination, std::string_view text) {
    writeFileAtomically(destination, std::as_bytes(std::span(text.data(), text.size())));
}

int removeStaleTemporaries(const fs::path& directory) {
    int removed = 0;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(directory, error)) {
        const std::string name = entry.path().filename().string();
        const size_t at = name.rfind(kMarker);
        if (at == std::string::npos) continue;
        const pid_t owner = static_cast<pid_t>(std::atoi(name.c_str() + at + kMarker.size()));
        // EPERM: the process lives, and is another user's.
        if (owner > 0 && (owner == ::getpid() || ::kill(owner, 0) == 0 || errno == EPERM)) continue;
        std::error_code ignored;
        if (fs::remove_all(entry.path(), ignored) > 0) ++removed;
    }
    return removed;
}

std::string readFile(const fs::path& path) {
    if (fs::is_directory(path)) throw InputError(path.string(), "is a directory", "name a file");
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) throw InputError(path.string(), "cannot be read: " + systemMessage(), "check the path");
    std::string bytes;
    char block[1 << 16];
    size_t count = 0;
    while ((count = std::fread(block, 1, sizeof block, file)) > 0) bytes.append(block, count);
    const bool failed = std::ferror(file) != 0;
    std::fclose(file);
    if (failed) throw InputError(path.string(), "cannot be read to its end");
    return bytes;
}

}  // namespace prt
