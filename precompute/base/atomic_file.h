// Files that appear whole or not at all.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace prt {

/// A file being written under a temporary name beside its destination, renamed into place by commit().
/// The destructor removes what was not committed.
class AtomicFile {
  public:
    /// @throws OutputError  the directory does not exist or cannot be written
    explicit AtomicFile(std::filesystem::path destination);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Where to write until commit(); an empty file exists there.
    const std::filesystem::path& temporaryPath() const { return temporary_; }
    /// Flushes to disk (fsync) and renames over the destination.
    /// @throws OutputError  disk full, or the rename failed; the destination is then unchanged
    void commit();

  private:
    std::filesystem::path destination_, temporary_;
    bool committed_ = false;
};

/// Writes all bytes, or throws OutputError and leaves what was there.
void writeFileAtomically(const std::filesystem::path& destination, std::span<const std::byte> bytes);
void writeFileAtomically(const std::filesystem::path& destination, std::string_view text);

/// Removes temporaries that killed processes left in a directory (those of living processes stay).
/// @return how many were removed
int removeStaleTemporaries(const std::filesystem::path& directory);

/// @return the file's bytes
/// @throws InputError  missing, unreadable or a directory
std::string readFile(const std::filesystem::path& path);

}  // namespace prt
