// Frames go to ffmpeg through a socket: writing to one that nobody reads any more is an error, not a signal.
#include "tools/video.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

#include "precompute/base/atomic_file.h"
#include "precompute/base/check.h"
#include "precompute/base/error.h"

extern char** environ;

namespace prt::tools {
namespace {

struct Format {
    std::string_view extension;
    const char* muxer;
    bool evenSize;  // 4:2:0
    std::vector<std::string> codec;
};

// Colours as HD video has them, and said so: players guess otherwise.
const std::vector<std::string> kRec709 = {"-vf",
                                          "scale=out_color_matrix=bt709:out_range=tv",
                                          "-pix_fmt",
                                          "yuv420p",
                                          "-colorspace",
                                          "bt709",
                                          "-color_primaries",
                                          "bt709",
                                          "-color_trc",
                                          "iec61966-2-1"};

const std::vector<Format>& formats() {
    const auto with709 = [](std::vector<std::string> codec) {
        codec.insert(codec.end(), kRec709.begin(), kRec709.end());
        return codec;
    };
    static const std::vector<Format> kFormats = {
        {".mp4", "mp4", true, with709({"-c:v", "libx264", "-crf", "16", "-movflags", "+faststart"})},
        {".mkv", "matroska", true, with709({"-c:v", "libx264", "-crf", "16"})},
        {".webm", "webm", true, with709({"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1"})},
        {".gif",
         "gif",
         false,
         {"-filter_complex", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "-loop", "0"}}};
    return kFormats;
}

const Format* formatOf(const std::string& file) {
    for (const Format& format : formats())
        if (file.size() > format.extension.size() && file.ends_with(format.extension)) return &format;
    return nullptr;
}

class Descriptor {
  public:
    explicit Descriptor(int number = -1) : number_(number) {}
    ~Descriptor() { close(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const { return number_; }
    void close() {
        if (number_ >= 0) ::close(number_);
        number_ = -1;
    }
    void take(int number) {
        close();
        number_ = number;
    }

  private:
    int number_;
};

}  // namespace

bool isVideoName(const std::string& file) { return formatOf(file) != nullptr; }

struct VideoWriter::State {
    State(const std::string& name, int w, int h) : file(name), target(name), width(w), height(h) {}
    ~State() {
        if (process <= 0) return;
        ::kill(process, SIGKILL);
        ::waitpid(process, nullptr, 0);
    }
    void start(const std::vector<std::string>& arguments);
    // Waits for ffmpeg to end, and throws unless it says that all is well.
    void wait();
    [[noreturn]] void fail();

    std::string file;
    AtomicFile target;
    int width, height;
    pid_t process = 0;  // 0: not running
    int status = 0;
    Descriptor pixels, words;
};

void VideoWriter::State::start(const std::vector<std::string>& arguments) {
    int ends[2] = {-1, -1};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        throw OutputError(file, fmt::format("no socket: {}", std::strerror(errno)));
    pixels.take(ends[0]);
    const Descriptor other(ends[1]);
    words.take(::memfd_create("prt-ffmpeg", MFD_CLOEXEC));
    if (words.number() < 0) throw OutputError(file, fmt::format("no memory file: {}", std::strerror(errno)));

    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, other.number(), 0);
    posix_spawn_file_actions_addopen(&files, 1, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, words.number(), 2);
    // In a group of its own: Ctrl-C in a terminal is for the caller, who stops it then.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::vector<char*> argv;
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const int error = ::posix_spawnp(&process, argv.front(), &files, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error == 0) return;
    process = 0;
    if (error == ENOENT)
        throw InputError("ffmpeg", "is not installed, and videos are made by it",
                         "install the package ffmpeg, or write frames: -o frames/{frame}.png");
    throw InputError("ffmpeg", fmt::format("cannot be started: {}", std::strerror(error)));
}

void VideoWriter::State::wait() {
    pixels.close();
    while (process > 0) {
        const pid_t ended = ::waitpid(process, &status, WNOHANG);
        if (ended == process) {
            process = 0;
            break;
        }
        throwIfInterrupted();
        ::poll(nullptr, 0, 10);
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail();
}

void VideoWriter::State::fail() {
    std::array<char, 4096> text{};
    const off_t size = ::lseek(words.number(), 0, SEEK_END);
    const off_t from = std::max<off_t>(0, size - off_t(text.size()));
    const ssize_t got = ::pread(words.number(), text.data(), text.size(), from);
    std::string_view said(text.data(), size_t(std::max<ssize_t>(got, 0)));
    while (!said.empty() && (said.back() == '\n' || said.back() == '\r')) said.remove_suffix(1);
    if (const size_t line = said.find_last_of("\n\r"); line != std::string_view::npos)
        said.remove_prefix(line + 1);
    throw OutputError(file, said.empty() ? "ffmpeg failed without a word" : fmt::format("ffmpeg: {}", said));
}

void checkVideoSize(const std::string& file, int width, int height) {
    const Format* format = formatOf(file);
    PRT_CHECK(format != nullptr);
    if (format->evenSize && (width % 2 != 0 || height % 2 != 0))
        throw UsageError(
            "--size",
            fmt::format("{}x{} is odd, {} needs an even width and height", width, height, format->extension),
            fmt::format("for example {}x{}", width + width % 2, height + height % 2));
}

VideoWriter::VideoWriter(const std::string& file, int width, int height, double framesPerSecond) {
    const Format* format = formatOf(file);
    checkVideoSize(file, width, height);
    PRT_CHECK_LT(0.0, framesPerSecond);
    state_ = std::make_unique<State>(file, width, height);
    std::vector<std::string> arguments = {"ffmpeg",
                                          "-hide_banner",
                                          "-loglevel",
                                          "error",
                                          "-y",
                                          "-f",
                                          "rawvideo",
                                          "-pix_fmt",
                                          "rgb24",
                                          "-s",
                                          fmt::format("{}x{}", width, height),
                                          "-r",
                                          fmt::format("{:.12g}", framesPerSecond),
                                          "-i",
                                          "pipe:0"};
    arguments.insert(arguments.end(), format->codec.begin(), format->codec.end());
    // A path that starts with a dash, or has a colon, is no option and no protocol behind "file:".
    arguments.insert(arguments.end(),
                     {"-f", format->muxer, "file:" + state_->target.temporaryPath().string()});
    state_->start(arguments);
}

VideoWriter::~VideoWriter() = default;

void VideoWriter::add(const ByteImage& frame) {
    PRT_CHECK_EQ(frame.channels, 3);
    PRT_CHECK_EQ(frame.width, state_->width);
    PRT_CHECK_EQ(frame.height, state_->height);
    size_t sent = 0;
    while (sent < frame.pixels.size()) {
        throwIfInterrupted();
        const ssize_t count = ::send(state_->pixels.number(), frame.pixels.data() + sent,
                                     frame.pixels.size() - sent, MSG_NOSIGNAL);
        if (count >= 0) {
            sent += size_t(count);
        } else if (errno != EINTR) {
            state_->wait();
            throw OutputError(state_->file, "ffmpeg ended before the last frame");
        }
    }
}

void VideoWriter::finish() {
    state_->wait();
    state_->target.commit();
}

}  // namespace prt::tools
