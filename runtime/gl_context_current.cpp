// Sources: EGL 1.5, GLX 1.4 and OSMesa, each for which context is current and for names of functions.
#include <dlfcn.h>

#include "precompute/base/error.h"
#include "runtime/gl_backend.h"

namespace prt {
namespace {

/// Two functions of an interface that is in the process already.
struct Interface {
    const char *file, *current, *getProc;
};
constexpr Interface kInterfaces[] = {{"libEGL.so.1", "eglGetCurrentContext", "eglGetProcAddress"},
                                     {"libGLX.so.0", "glXGetCurrentContext", "glXGetProcAddressARB"},
                                     {"libGL.so.1", "glXGetCurrentContext", "glXGetProcAddressARB"},
                                     {"libOSMesa.so.8", "OSMesaGetCurrentContext", "OSMesaGetProcAddress"}};

class CallerBackend : public GlBackend {
  public:
    explicit CallerBackend(GlGetProc getProc) : getProc_(getProc) {
        for (const Interface& known : kInterfaces) {
            void* library = ::dlopen(known.file, RTLD_LAZY | RTLD_LOCAL | RTLD_NOLOAD);
            if (!library) continue;
            const auto current = reinterpret_cast<Current>(::dlsym(library, known.current));
            void* context = current ? current() : nullptr;
            if (!context) continue;
            current_ = current;
            context_ = context;
            if (!getProc_) getProc_ = reinterpret_cast<GlGetProc>(::dlsym(library, known.getProc));
            break;
        }
        // Mesa's own note of what a thread draws into: OSMesa changes it without EGL or GLX seeing.
        if (void* mesa = ::dlopen("libglapi.so.0", RTLD_LAZY | RTLD_LOCAL | RTLD_NOLOAD)) {
            mesaCurrent_ = reinterpret_cast<Current>(::dlsym(mesa, "_glapi_get_context"));
            if (mesaCurrent_) mesaContext_ = mesaCurrent_();
        }
        if (!getProc_)
            throw InputError("OpenGL", "no context of EGL, GLX or OSMesa is current on this thread",
                             "make one current first, or name the function that resolves OpenGL's names");
    }

    GlContextKind kind() const override { return GlContextKind::Current; }
    GlProc proc(const char* name) const override { return getProc_(name); }
    // Of an interface that is not known here the caller's word is taken.
    bool isCurrent() const override {
        return (!current_ || current_() == context_) && (!mesaContext_ || mesaCurrent_() == mesaContext_);
    }
    void makeCurrent() const override {
        if (!isCurrent())
            throw Error(
                "OpenGL", "the caller's context is not current on this thread",
                "make it current before using or destroying what was made in it; when an OSMesa context "
                "was used meanwhile, release it first");
    }
    void release() const override {}

  private:
    using Current = void* (*)();
    GlGetProc getProc_ = nullptr;
    Current current_ = nullptr;
    void* context_ = nullptr;
    Current mesaCurrent_ = nullptr;
    void* mesaContext_ = nullptr;
};

}  // namespace

std::unique_ptr<GlBackend> makeCallerBackend(GlGetProc getProc) {
    return std::make_unique<CallerBackend>(getProc);
}

}  // namespace prt
