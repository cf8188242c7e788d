// The bundle: files under fixed names, and a manifest that is renamed into place last.
// Sources: POSIX rename(2), link(2), flock(2), fsync(2); xxHash (XXH3, 128 bits, canonical byte order).
#include "precompute/io/bundle.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <set>
#include <system_error>

#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "precompute/io/exr_conventions.h"
#include "precompute/io/manifest.h"

namespace prt {
namespace fs = std::filesystem;
namespace {

// As in atomic_file.cpp: removeStaleTemporaries knows these names.
constexpr const char* kMarker = ".prt-tmp-";
constexpr const char* kBackupSuffix = "-backup";
std::atomic<int> gCounter{0};

std::string hex(const XXH128_hash_t& hash) {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, hash);
    std::string text;
    for (unsigned char byte : canonical.digest) text += fmt::format("{:02x}", byte);
    return text;
}

std::string systemMessage(int error) { return std::generic_category().message(error); }

fs::path temporaryFor(const fs::path& destination, const char* suffix = "") {
    fs::path path = destination;
    // "b" keeps the counter apart from that of AtomicFile.
    path += fmt::format("{}{}-b{}{}", kMarker, ::getpid(), gCounter++, suffix);
    return path;
}

bool isTemporary(const fs::path& path) { return path.filename().string().find(kMarker) != std::string::npos; }

/// Flushes a file or a directory's entries to disk.
bool flushPath(const fs::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return false;
    const bool flushed = ::fsync(file) == 0;
    const int error = errno;
    ::close(file);
    errno = error;
    return flushed;
}

/// One committer at a time: an exclusive lock on the directory, released by the kernel when a process dies.
class DirectoryLock {
  public:
    explicit DirectoryLock(const fs::path& directory)
        : file_(::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
        if (file_ < 0) throw OutputError(directory.string(), "cannot be opened: " + systemMessage(errno));
        while (::flock(file_, LOCK_EX) != 0)
            // Some network file systems have no locks; a lone writer is safe without.
            if (errno != EINTR) break;
    }
    ~DirectoryLock() { ::close(file_); }
    DirectoryLock(const DirectoryLock&) = delete;
    DirectoryLock& operator=(const DirectoryLock&) = delete;

  private:
    int file_;
};

std::string relativeName(const fs::path& path, const fs::path& directory) {
    return path.lexically_relative(directory).generic_string();
}

std::vector<fs::path> filesBelow(const fs::path& directory) {
    std::vector<fs::path> files;
    std::error_code error;
    for (fs::recursive_directory_iterator it(directory, error), end; !error && it != end; it.increment(error))
        if (!it->is_directory(error)) files.push_back(it->path());
    return files;
}

void removeTemporariesBelow(const fs::path& directory) {
    removeStaleTemporaries(directory);
    std::error_code error;
    for (fs::recursive_directory_iterator it(directory, error), end; !error && it != end; it.increment(error))
        if (it->is_directory(error)) removeStaleTemporaries(it->path());
}

bool sameBytes(const fs::path& path, const BundleFile& file) {
    std::error_code error;
    return fs::file_size(path, error) == file.bytes && !error && xxh3HexOfFile(path) == file.xxh3;
}

/// A commit that was killed between its renames has left what the manifest speaks of as backups.
void restoreBackups(const fs::path& directory, const Manifest& manifest) {
    for (const fs::path& path : filesBelow(directory)) {
        const std::string name = path.filename().string();
        if (!isTemporary(path) || !name.ends_with(kBackupSuffix)) continue;
        const fs::path original = path.parent_path() / name.substr(0, name.find(kMarker));
        const std::string inBundle = relativeName(original, directory);
        const auto file = std::find_if(manifest.files.begin(), manifest.files.end(),
                                       [&](const BundleFile& entry) { return entry.name == inBundle; });
        std::error_code error;
        if (file != manifest.files.end() && !sameBytes(original, *file) && sameBytes(path, *file)) {
            fs::rename(path, original, error);
            if (!error) logNote(fmt::format("{}: restored after an interrupted run", original.string()));
        }
        // Under the lock no living process is between its renames.
        fs::remove(path, error);
    }
}

}  // namespace

std::string xxh3Hex(const void* bytes, size_t size) { return hex(XXH3_128bits(bytes, size)); }

std::string xxh3HexOfFile(const fs::path& path) {
    if (fs::is_directory(path)) throw InputError(path.string(), "is a directory", "name a file");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file) throw InputError(path.string(), "cannot be read: " + systemMessage(errno));
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                                XXH3_freeState);
    PRT_CHECK(state && XXH3_128bits_reset(state.get()) == XXH_OK);
    std::vector<char> block(size_t(1) << 20);
    size_t count = 0;
    while ((count = std::fread(block.data(), 1, block.size(), file.get())) > 0)
        XXH3_128bits_update(state.get(), block.data(), count);
    if (std::ferror(file.get())) throw InputError(path.string(), "cannot be read to its end");
    return hex(XXH3_128bits_digest(state.get()));
}

Bundle Bundle::open(const fs::path& directory) {
    std::error_code error;
    if (!fs::exists(directory, error))
        throw InputError(directory.string(), "there is no such bundle", "make it with prt precompute");
    const fs::path manifestPath = directory / kManifestName;
    if (!fs::is_directory(directory, error) || !fs::exists(manifestPath, error))
        throw InputError(directory.string(), "is not a bundle (it has no manifest.json)",
                         "make one with prt precompute");
    Manifest manifest = parseManifest(readFile(manifestPath), manifestPath.string());
    Bundle bundle;
    bundle.directory_ = directory;
    bundle.files_ = std::move(manifest.files);
    bundle.sections_ = std::move(manifest.sections);
    return bundle;
}

const BundleFile* Bundle::find(const std::string& name) const {
    for (const BundleFile& file : files_)
        if (file.name == name) return &file;
    return nullptr;
}

std::string Bundle::section(const std::string& name) const {
    const auto it = sections_.find(name);
    return it == sections_.end() ? "{}" : it->second;
}

const std::map<std::string, std::string>& Bundle::conventions() const { return fileConventions(); }

std::vector<std::string> Bundle::sectionNames() const {
    std::vector<std::string> names;
    for (const auto& [name, section] : sections_) names.push_back(name);
    return names;
}

namespace {

struct Staleness {
    std::string reason;
    const BundleFile* culprit = nullptr;  ///< the file to renew first
};

Staleness findStaleness(const Bundle& bundle, const BundleFile& file, bool verifyBytes,
                        std::set<std::string>& visited) {
    if (!visited.insert(file.name).second) return {};
    const fs::path path = bundle.pathOf(file.name);
    std::error_code error;
    const uint64_t bytes = fs::file_size(path, error);
    if (error) return {"missing", &file};
    if (bytes != file.bytes || (verifyBytes && xxh3HexOfFile(path) != file.xxh3))
        return {"changed since it was written", &file};
    for (const auto& [input, hash] : file.madeFrom) {
        // What lies outside the bundle (source mesh, environment) can't be checked here.
        const BundleFile* source = bundle.find(input);
        if (!source) continue;
        if (Staleness stale = findStaleness(bundle, *source, verifyBytes, visited); stale.culprit) {
            stale.reason = fmt::format("made from {}, which is {}", input, stale.reason);
            return stale;
        }
        if (source->xxh3 != hash) return {"made from another " + input, &file};
    }
    return {};
}

}  // namespace

std::string Bundle::staleReason(const std::string& name, bool verifyBytes) const {
    const BundleFile* file = find(name);
    if (!file) return "not in the bundle";
    std::set<std::string> visited;
    return findStaleness(*this, *file, verifyBytes, visited).reason;
}

void Bundle::require(const std::string& name, const std::string& command) const {
    const BundleFile* file = find(name);
    if (!file)
        throw InputError(directory_.string(), "has no " + name,
                         command.empty() ? std::string() : "run " + command);
    std::set<std::string> visited;
    const Staleness stale = findStaleness(*this, *file, true, visited);
    if (!stale.culprit) return;
    const std::string& renew = stale.culprit->madeBy.empty() ? command : stale.culprit->madeBy;
    throw InputError(pathOf(name).string(), "is stale: " + stale.reason,
                     renew.empty() ? std::string() : "run " + renew);
}

struct BundleTransaction::State {
    struct Staged {
        BundleFile file;
        fs::path temporary;
    };
    struct Renamed {
        fs::path destination, backup;  // backup empty: there was no file
    };

    fs::path directory;
    std::vector<fs::path> madeDirectories;  // outermost first
    std::vector<Staged> staged;
    std::map<std::string, std::string> sections;
    bool committed = false;

    Staged* find(const std::string& name) {
        for (Staged& entry : staged)
            if (entry.file.name == name) return &entry;
        return nullptr;
    }

    /// Makes a directory and its parents, remembering which are new.
    void makeDirectories(const fs::path& path) {
        std::error_code error;
        if (path.empty() || fs::is_directory(path, error)) return;
        makeDirectories(path.parent_path());
        if (fs::create_directory(path, error)) {
            madeDirectories.push_back(path);
        } else if (error || !fs::is_directory(path)) {
            const std::string problem = error ? error.message() : "a file is in the way";
            removeMadeDirectories();
            throw OutputError(path.string(), "cannot be made: " + problem,
                              "check that the place exists and is writable");
        }
    }
    void removeMadeDirectories() {
        std::error_code ignored;
        // Only empty ones go; another process may have put something there meanwhile.
        for (size_t i = madeDirectories.size(); i-- > 0;) fs::remove(madeDirectories[i], ignored);
        madeDirectories.clear();
    }

    std::optional<Manifest> readManifest() const {
        const fs::path path = directory / kManifestName;
        if (!fs::exists(path)) return std::nullopt;
        return parseManifest(readFile(path), path.string());
    }

    void renameStaged(std::vector<Renamed>& renamed) {
        for (const Staged& entry : staged) {
            const fs::path destination = directory / entry.file.name;
            Renamed step{destination, {}};
            if (fs::is_directory(destination))
                throw OutputError(destination.string(), "is a directory where a file should go", "remove it");
            if (fs::exists(destination)) {
                step.backup = temporaryFor(destination, kBackupSuffix);
                // A link leaves the old file in place until the new one replaces it; not all file systems
                // can.
                if (::link(destination.c_str(), step.backup.c_str()) != 0 &&
                    ::rename(destination.c_str(), step.backup.c_str()) != 0)
                    throw OutputError(destination.string(), "cannot be replaced: " + systemMessage(errno));
            }
            renamed.push_back(step);
            if (::rename(entry.temporary.c_str(), destination.c_str()) != 0)
                throw OutputError(destination.string(),
                                  "cannot be renamed into place: " + systemMessage(errno));
        }
    }
    static void rollBack(const std::vector<Renamed>& renamed) {
        std::error_code ignored;
        for (const Renamed& step : renamed) {
            if (step.backup.empty()) {
                fs::remove(step.destination, ignored);
            } else {
                fs::rename(step.backup, step.destination, ignored);
                // Two links to one file: rename does nothing then.
                fs::remove(step.backup, ignored);
            }
        }
    }
};

BundleTransaction::BundleTransaction(const fs::path& directory, bool create)
    : state_(std::make_unique<State>()) {
    // "house.prt/" has an empty last part.
    const bool trailing = !directory.has_filename() && directory.has_parent_path();
    state_->directory = trailing ? directory.parent_path() : directory;
    const fs::path& path = state_->directory;
    std::error_code error;
    if (!fs::exists(path, error)) {
        if (!create)
            throw InputError(path.string(), "there is no such bundle", "make it with prt precompute");
        state_->makeDirectories(path);
    } else if (!fs::is_directory(path, error)) {
        throw OutputError(path.string(), "is a file, not a bundle's directory", "choose another name");
    }
    if (::access(path.c_str(), R_OK | W_OK | X_OK) != 0) {
        const int problem = errno;
        state_->removeMadeDirectories();
        throw OutputError(path.string(), "cannot be written: " + systemMessage(problem),
                          "check that the place is writable");
    }
    const DirectoryLock lock(path);
    if (const std::optional<Manifest> manifest = state_->readManifest()) {
        restoreBackups(path, *manifest);
    } else {
        if (!create)
            throw InputError(path.string(), "is not a bundle (it has no manifest.json)",
                             "make one with prt precompute");
        for (const fs::path& file : filesBelow(path))
            if (!isTemporary(file))
                throw InputError(path.string(),
                                 fmt::format("is not a bundle, and holds {}", relativeName(file, path)),
                                 "name a new or an empty directory");
    }
    removeTemporariesBelow(path);
}

BundleTransaction::~BundleTransaction() {
    if (state_->committed) return;
    std::error_code ignored;
    for (const auto& entry : state_->staged) fs::remove(entry.temporary, ignored);
    state_->removeMadeDirectories();
}

fs::path BundleTransaction::stage(const std::string& name, std::map<std::string, std::string> madeFrom,
                                  std::string madeBy) {
    PRT_CHECK(isBundleFileName(name));
    State::Staged* entry = state_->find(name);
    if (!entry) {
        const fs::path destination = state_->directory / name;
        state_->makeDirectories(destination.parent_path());
        state_->staged.push_back({{name, 0, {}, {}, {}}, temporaryFor(destination)});
        entry = &state_->staged.back();
    }
    entry->file.madeFrom = std::move(madeFrom);
    entry->file.madeBy = std::move(madeBy);
    return entry->temporary;
}

std::string BundleTransaction::hashOfStaged(const std::string& name) const {
    const State::Staged* entry = state_->find(name);
    PRT_CHECK(entry != nullptr);
    return xxh3HexOfFile(entry->temporary);
}

void BundleTransaction::setMadeFrom(const std::string& name, std::map<std::string, std::string> madeFrom) {
    State::Staged* entry = state_->find(name);
    PRT_CHECK(entry != nullptr);
    entry->file.madeFrom = std::move(madeFrom);
}

void BundleTransaction::setSection(const std::string& name, std::string json) {
    PRT_CHECK(isJson(json));
    state_->sections[name] = std::move(json);
}

void BundleTransaction::commit() {
    State& state = *state_;
    PRT_CHECK(!state.committed);
    for (State::Staged& entry : state.staged) {
        std::error_code error;
        entry.file.bytes = fs::file_size(entry.temporary, error);
        const fs::path destination = state.directory / entry.file.name;
        if (error) throw OutputError(destination.string(), "was never written: " + error.message());
        entry.file.xxh3 = xxh3HexOfFile(entry.temporary);
        if (!flushPath(entry.temporary))
            throw OutputError(destination.string(), "cannot be flushed: " + systemMessage(errno));
    }
    const DirectoryLock lock(state.directory);
    // What another process committed meanwhile stays, but for the files written here.
    Manifest manifest = state.readManifest().value_or(Manifest{});
    restoreBackups(state.directory, manifest);
    for (const State::Staged& entry : state.staged) {
        const auto it = std::find_if(manifest.files.begin(), manifest.files.end(),
                                     [&](const BundleFile& file) { return file.name == entry.file.name; });
        if (it == manifest.files.end())
            manifest.files.push_back(entry.file);
        else
            *it = entry.file;
    }
    for (const auto& [name, section] : state.sections) manifest.sections[name] = section;

    std::vector<State::Renamed> renamed;
    try {
        state.renameStaged(renamed);
        writeFileAtomically(state.directory / kManifestName, manifestText(manifest));
    } catch (...) {
        State::rollBack(renamed);
        throw;
    }
    state.committed = true;
    std::error_code ignored;
    for (const State::Renamed& step : renamed)
        if (!step.backup.empty()) fs::remove(step.backup, ignored);
    flushPath(state.directory);
}

}  // namespace prt
