// Sources: OSMesa's interface (GL/osmesa.h of Mesa 22.3).
#include <GL/osmesa.h>

#include <cstdint>

#include "precompute/base/error.h"
#include "runtime/gl_backend.h"

// OSMesa never frees some 300 bytes of each context, which LeakSanitizer finds; said here, every program that
// draws is spared. Mesa's EGL keeps its displays and devices, too.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define PRT_LEAK_SANITIZER
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define PRT_LEAK_SANITIZER
#endif
#ifdef PRT_LEAK_SANITIZER
extern "C" {
const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() { return "leak:libOSMesa\nleak:libEGL\nleak:swrast_dri\n"; }
// The checker guesses where libraries that were opened at run time keep their thread-local storage, and reads
// wild addresses where glibc's bookkeeping is not what it expects.
const char* __asan_default_options();
const char* __asan_default_options() { return "intercept_tls_get_addr=0"; }
const char* __lsan_default_options();
const char* __lsan_default_options() { return "print_suppressions=0"; }  // stderr is for our own lines
}
#endif

namespace prt {
namespace {

constexpr const char* kRemedy = "install libosmesa6 (apt-get install libosmesa6)";

struct OsMesa {
    decltype(&OSMesaCreateContextAttribs) createContextAttribs = nullptr;
    decltype(&OSMesaDestroyContext) destroyContext = nullptr;
    decltype(&OSMesaGetCurrentContext) getCurrentContext = nullptr;
    decltype(&OSMesaMakeCurrent) makeCurrent = nullptr;
    decltype(&OSMesaGetProcAddress) getProcAddress = nullptr;

    OsMesa() {
        void* library = openGlLibrary("PRT_OSMESA_LIBRARY",
                                      {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}, kRemedy);
        const auto resolve = [&]<typename F>(F& function, const char* name) {
            function = reinterpret_cast<F>(glLibrarySymbol(library, "libOSMesa", name, kRemedy));
        };
        resolve(createContextAttribs, "OSMesaCreateContextAttribs");
        resolve(destroyContext, "OSMesaDestroyContext");
        resolve(getCurrentContext, "OSMesaGetCurrentContext");
        resolve(makeCurrent, "OSMesaMakeCurrent");
        resolve(getProcAddress, "OSMesaGetProcAddress");
    }
};

class OsMesaBackend : public GlBackend {
  public:
    OsMesaBackend() {
        const int attributes[] = {OSMESA_FORMAT,
                                  OSMESA_RGBA,
                                  OSMESA_PROFILE,
                                  OSMESA_CORE_PROFILE,
                                  OSMESA_CONTEXT_MAJOR_VERSION,
                                  4,
                                  OSMESA_CONTEXT_MINOR_VERSION,
                                  5,
                                  0,
                                  0};
        context_ = mesa_.createContextAttribs(attributes, nullptr);
        if (!context_)
            throw InputError("OpenGL", "libOSMesa makes no OpenGL 4.5 core context",
                             "Mesa 22.3 or newer is needed, as in Debian 12");
    }
    ~OsMesaBackend() override {
        if (isCurrent()) release();
        mesa_.destroyContext(context_);
    }
    OsMesaBackend(const OsMesaBackend&) = delete;
    OsMesaBackend& operator=(const OsMesaBackend&) = delete;

    GlContextKind kind() const override { return GlContextKind::OsMesa; }
    GlProc proc(const char* name) const override { return mesa_.getProcAddress(name); }
    bool isCurrent() const override { return mesa_.getCurrentContext() == context_; }
    void makeCurrent() const override {
        if (!mesa_.makeCurrent(context_, &pixel_, GL_UNSIGNED_BYTE, 1, 1))
            throw Error("OpenGL", "the context cannot be made current");
    }
    void release() const override { mesa_.makeCurrent(nullptr, nullptr, 0, 0, 0); }

  private:
    OsMesa mesa_;
    OSMesaContext context_ = nullptr;
    mutable uint32_t pixel_ = 0;  // OSMesa insists on a buffer; frames are drawn into framebuffer objects
};

}  // namespace

std::unique_ptr<GlBackend> makeOsMesaBackend() { return std::make_unique<OsMesaBackend>(); }

}  // namespace prt
