// Moving pictures, encoded by ffmpeg.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "precompute/io/image.h"

namespace prt::tools {

/// Whether the name's extension is that of a video: .mp4, .mkv (H.264), .webm (VP9) or .gif.
bool isVideoName(const std::string& file);
/// @param file  of which isVideoName() is true
/// @throws UsageError  an odd size, but for .gif
void checkVideoSize(const std::string& file, int width, int height);

/// Hands frames to ffmpeg as raw pixels. The file appears when it is complete: until finish() it has another
/// name, and the destructor stops ffmpeg and removes it.
class VideoWriter {
  public:
    /// Starts ffmpeg, found in PATH.
    /// @param file           of which isVideoName() is true
    /// @param width, height  of every frame, see checkVideoSize
    /// @param framesPerSecond  > 0
    /// @throws UsageError   an odd size
    /// @throws InputError   ffmpeg is not installed
    /// @throws OutputError  the file cannot be written
    VideoWriter(const std::string& file, int width, int height, double framesPerSecond);
    ~VideoWriter();
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    /// @param frame  of 3 channels and the size of the video
    /// @throws OutputError  ffmpeg ended, with its last words; Interrupted
    void add(const ByteImage& frame);
    /// After the last frame.
    /// @throws OutputError  ffmpeg failed, with its last words; the file cannot be written; Interrupted
    void finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace prt::tools
