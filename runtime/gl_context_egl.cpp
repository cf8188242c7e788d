// Sources: EGL 1.5; EGL_EXT_device_enumeration, EGL_EXT_platform_device, EGL_MESA_device_software,
// EGL_MESA_platform_surfaceless, EGL_KHR_surfaceless_context, EGL_KHR_no_config_context.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "precompute/base/error.h"
#include "precompute/base/log.h"
#include "runtime/gl_backend.h"

namespace prt {
namespace {

constexpr const char* kRemedy = "install libegl1 (apt-get install libegl1), or draw with osmesa";

struct Egl {
    decltype(&eglBindAPI) bindApi = nullptr;
    decltype(&eglChooseConfig) chooseConfig = nullptr;
    decltype(&eglCreateContext) createContext = nullptr;
    decltype(&eglDestroyContext) destroyContext = nullptr;
    decltype(&eglGetCurrentContext) getCurrentContext = nullptr;
    decltype(&eglGetError) getError = nullptr;
    decltype(&eglGetProcAddress) getProcAddress = nullptr;
    decltype(&eglInitialize) initialize = nullptr;
    decltype(&eglMakeCurrent) makeCurrent = nullptr;
    decltype(&eglQueryAPI) queryApi = nullptr;
    decltype(&eglQueryString) queryString = nullptr;

    Egl() {
        void* library = openGlLibrary("PRT_EGL_LIBRARY", {"libEGL.so.1", "libEGL.so"}, kRemedy);
        const auto resolve = [&]<typename F>(F& function, const char* name) {
            function = reinterpret_cast<F>(glLibrarySymbol(library, "libEGL", name, kRemedy));
        };
        resolve(bindApi, "eglBindAPI");
        resolve(chooseConfig, "eglChooseConfig");
        resolve(createContext, "eglCreateContext");
        resolve(destroyContext, "eglDestroyContext");
        resolve(getCurrentContext, "eglGetCurrentContext");
        resolve(getError, "eglGetError");
        resolve(getProcAddress, "eglGetProcAddress");
        resolve(initialize, "eglInitialize");
        resolve(makeCurrent, "eglMakeCurrent");
        resolve(queryApi, "eglQueryAPI");
        resolve(queryString, "eglQueryString");
    }
    template <typename F>
    F extension(const char* name) const {
        return reinterpret_cast<F>(getProcAddress(name));
    }
};

bool hasWord(const char* words, std::string_view wanted) {
    const std::string padded = fmt::format(" {} ", words ? words : "");
    return padded.find(fmt::format(" {} ", wanted)) != std::string::npos;
}

/// Somewhere a context might be made.
struct Place {
    EGLDisplay display = EGL_NO_DISPLAY;
    std::string name;
    bool software = false;
};

/// The number in PRT_EGL_DEVICE, or -1.
int wantedDevice(int count) {
    const char* text = std::getenv("PRT_EGL_DEVICE");
    if (!text || !*text) return -1;
    const std::string_view all(text);
    int number = -1;
    const auto [end, error] = std::from_chars(all.data(), all.data() + all.size(), number);
    if (error != std::errc() || end != all.data() + all.size() || number < 0 || number >= count)
        throw InputError("PRT_EGL_DEVICE", fmt::format("'{}' is not the number of a device", text),
                         fmt::format("there are {}, counted from 0", count));
    return number;
}

/// GPUs first, then software.
std::vector<Place> findPlaces(const Egl& egl) {
    const char* client = egl.queryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto getDisplay = egl.extension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    std::vector<Place> places;
    if (!getDisplay || !hasWord(client, "EGL_EXT_platform_base")) return places;
    const auto queryDevices = egl.extension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const auto queryDevice = egl.extension<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    int wanted = -1;
    if (hasWord(client, "EGL_EXT_platform_device") && queryDevices && queryDevice) {
        EGLDeviceEXT devices[32];
        EGLint count = 0;
        if (!queryDevices(32, devices, &count)) count = 0;
        wanted = wantedDevice(count);
        for (int i = 0; i < count; ++i)
            if (wanted < 0 || i == wanted)
                places.push_back(
                    {getDisplay(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr),
                     fmt::format("EGL device {}", i),
                     hasWord(queryDevice(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software")});
    }
    std::stable_partition(places.begin(), places.end(), [](const Place& place) { return !place.software; });
    if (wanted < 0 && hasWord(client, "EGL_MESA_platform_surfaceless"))
        places.push_back(
            {getDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr), "EGL without a surface", true});
    return places;
}

const char* eglErrorName(EGLint error) {
    switch (error) {
        case EGL_SUCCESS:
            return "no reason given";
        case EGL_NOT_INITIALIZED:
            return "not initialized";
        case EGL_BAD_ACCESS:
            return "no access";
        case EGL_BAD_ALLOC:
            return "out of memory";
        case EGL_BAD_MATCH:
            return "no such version";
        case EGL_BAD_CONFIG:
            return "no such configuration";
        case EGL_CONTEXT_LOST:
            return "context lost";
        default:
            return "not supported";
    }
}

/// The thread's choice of OpenGL or OpenGL ES, put back.
class ApiScope {
  public:
    explicit ApiScope(const Egl& egl) : egl_(egl), before_(egl.queryApi()) { egl.bindApi(EGL_OPENGL_API); }
    ~ApiScope() { egl_.bindApi(before_); }
    ApiScope(const ApiScope&) = delete;
    ApiScope& operator=(const ApiScope&) = delete;

  private:
    const Egl& egl_;
    EGLenum before_;
};

/// @param config   out
/// @return         why there is none; empty: config holds one
std::string chooseConfig(const Egl& egl, EGLDisplay display, EGLConfig& config) {
    const char* extensions = egl.queryString(display, EGL_EXTENSIONS);
    if (!hasWord(extensions, "EGL_KHR_surfaceless_context")) return "needs a surface to draw on";
    config = nullptr;
    if (hasWord(extensions, "EGL_KHR_no_config_context") ||
        hasWord(extensions, "EGL_MESA_configless_context"))
        return {};
    const EGLint attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_DONT_CARE,
                                 EGL_NONE};
    EGLint count = 0;
    if (!egl.chooseConfig(display, attributes, &config, 1, &count) || count < 1) return "has no OpenGL";
    return {};
}

/// @param context  out
/// @return         why there is none; empty: context holds one
std::string createContext(const Egl& egl, EGLDisplay display, bool debug, EGLContext& context) {
    if (display == EGL_NO_DISPLAY) return "cannot be opened";
    EGLint major = 0, minor = 0;
    if (!egl.initialize(display, &major, &minor))
        return fmt::format("cannot be initialized ({})", eglErrorName(egl.getError()));
    if (major * 10 + minor < 15) return fmt::format("has EGL {}.{}, 1.5 is needed", major, minor);
    EGLConfig config = nullptr;
    if (std::string problem = chooseConfig(egl, display, config); !problem.empty()) return problem;
    // Told of a reset where the driver can; else without.
    for (const EGLint strategy : {EGL_LOSE_CONTEXT_ON_RESET, EGL_NO_RESET_NOTIFICATION}) {
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     5,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_CONTEXT_OPENGL_DEBUG,
                                     debug ? EGL_TRUE : EGL_FALSE,
                                     EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
                                     strategy,
                                     EGL_NONE};
        context = egl.createContext(display, config, EGL_NO_CONTEXT, attributes);
        if (context != EGL_NO_CONTEXT) return {};
    }
    return fmt::format("makes no OpenGL 4.5 core context ({})", eglErrorName(egl.getError()));
}

class EglBackend : public GlBackend {
  public:
    explicit EglBackend(bool debug) {
        const ApiScope api(egl_);
        std::string problems;
        for (const Place& place : findPlaces(egl_)) {
            const std::string problem = createContext(egl_, place.display, debug, context_);
            if (problem.empty()) {
                display_ = place.display;
                // Drawing in software where there is a GPU is a surprise worth a line.
                if (place.software && !problems.empty()) logWarning("drawing in software: " + problems);
                return;
            }
            problems += fmt::format("{}{} {}", problems.empty() ? "" : "; ", place.name, problem);
        }
        throw InputError("OpenGL", problems.empty() ? "EGL knows no device to draw on" : problems,
                         "install libegl-mesa0 or the GPU's driver, or draw with osmesa");
    }
    // The display stays: others may use it, the caller's own contexts among them.
    ~EglBackend() override {
        if (isCurrent()) release();
        egl_.destroyContext(display_, context_);
    }
    EglBackend(const EglBackend&) = delete;
    EglBackend& operator=(const EglBackend&) = delete;

    GlContextKind kind() const override { return GlContextKind::Egl; }
    GlProc proc(const char* name) const override { return egl_.getProcAddress(name); }
    bool isCurrent() const override { return egl_.getCurrentContext() == context_; }
    void makeCurrent() const override {
        if (!egl_.makeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
            throw Error("OpenGL", fmt::format("the context cannot be made current ({})",
                                              eglErrorName(egl_.getError())));
    }
    void release() const override {
        egl_.makeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }

  private:
    Egl egl_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlBackend> makeEglBackend(bool debug) { return std::make_unique<EglBackend>(debug); }

}  // namespace prt
