// The bundle NAME.prt/: a directory whose manifest.json is the commit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace prt {

inline constexpr int kBundleFormatVersion = 1;

/// One file of a bundle as the manifest knows it.
struct BundleFile {
    std::string name;  ///< relative, e.g. "tables/night.light-cosine.cube.exr"
    uint64_t bytes = 0;
    std::string xxh3;                             ///< 128 bits, hexadecimal
    std::map<std::string, std::string> madeFrom;  ///< name of each input → its hash when this file was made
    std::string madeBy;  ///< command that renews it, e.g. "prt compress out/house.prt"
};

/// A bundle opened for reading.
class Bundle {
  public:
    /// @throws InputError  no such directory, no or damaged manifest, another format version
    static Bundle open(const std::filesystem::path& directory);

    const std::filesystem::path& directory() const { return directory_; }
    const std::vector<BundleFile>& files() const { return files_; }
    const BundleFile* find(const std::string& name) const;
    std::filesystem::path pathOf(const std::string& name) const { return directory_ / name; }
    /// Section of the manifest ("precompute", "compress", …: settings and statistics) as JSON text; "{}" when
    /// absent.
    std::string section(const std::string& name) const;
    std::vector<std::string> sectionNames() const;
    /// Name → meaning of every convention its files follow (open() refuses bundles with others).
    const std::map<std::string, std::string>& conventions() const;

    /// Why a file can't be trusted: "" when it is current; else one phrase, e.g. "made from another
    /// visibility.exr" or "changed since it was written". Compares hashes along the graph of madeFrom within
    /// the bundle.
    /// @param verifyBytes  also hashes the file itself (else only its size is compared)
    std::string staleReason(const std::string& name, bool verifyBytes) const;
    /// @throws InputError  the file is absent, or stale; names the command that renews it
    void require(const std::string& name, const std::string& command) const;

  private:
    friend class BundleTransaction;
    std::filesystem::path directory_;
    std::vector<BundleFile> files_;
    std::map<std::string, std::string> sections_;
};

/// Changes to a bundle that appear together or not at all: files are staged under temporary names, then
/// flushed and renamed, the manifest last. Destroyed without commit(), it removes what it staged (and a
/// directory that it made).
class BundleTransaction {
  public:
    /// @param create  make the directory when it is not there (an existing bundle is updated; any other
    /// non-empty
    ///                directory is refused). Removes temporaries of killed runs.
    /// @throws OutputError, InputError
    BundleTransaction(const std::filesystem::path& directory, bool create);
    ~BundleTransaction();
    BundleTransaction(const BundleTransaction&) = delete;
    BundleTransaction& operator=(const BundleTransaction&) = delete;

    /// @return temporary path to write the file to
    std::filesystem::path stage(const std::string& name, std::map<std::string, std::string> madeFrom,
                                std::string madeBy);
    /// Hash of a staged file (after it was written), to be named in madeFrom of another.
    std::string hashOfStaged(const std::string& name) const;
    /// Names a file's inputs after staging it.
    void setMadeFrom(const std::string& name, std::map<std::string, std::string> madeFrom);
    void setSection(const std::string& name, std::string json);
    /// @throws OutputError
    void commit();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// xxh3-128 of bytes or of a file, 32 hexadecimal digits.
std::string xxh3Hex(const void* bytes, size_t size);
std::string xxh3HexOfFile(const std::filesystem::path& path);

}  // namespace prt
