// Sources: OSMesa's interface (GL/osmesa.h of Mesa 22.3), OpenGL 4.5 core profile, sections 20 (debug output)
// and 2.3.1 (errors).
#include "runtime/gl_context.h"

#include <GL/osmesa.h>
#include <dlfcn.h>

#include <cstdint>
#include <cstdio>
#include <utility>

#include "precompute/base/error.h"
#include "runtime/gl_functions.h"

// OSMesa never frees some 300 bytes of each context, which LeakSanitizer finds; said here, every program that
// draws is spared.
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
const char* __lsan_default_suppressions() { return "leak:libOSMesa\n"; }
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

struct OsMesa {
    decltype(&OSMesaCreateContextAttribs) createContextAttribs = nullptr;
    decltype(&OSMesaDestroyContext) destroyContext = nullptr;
    decltype(&OSMesaGetCurrentContext) getCurrentContext = nullptr;
    decltype(&OSMesaMakeCurrent) makeCurrent = nullptr;
    decltype(&OSMesaGetProcAddress) getProcAddress = nullptr;
};

constexpr const char* kRemedy = "install libosmesa6 (apt-get install libosmesa6)";

// RTLD_LOCAL keeps its OpenGL symbols away from any other OpenGL in the process. Never closed: LLVM inside
// does not survive that.
OsMesa openOsMesa() {
    void* library = nullptr;
    for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"})
        if ((library = ::dlopen(name, RTLD_NOW | RTLD_LOCAL))) break;
    if (!library) {
        const char* why = ::dlerror();
        throw InputError(
            "OpenGL", std::string("libOSMesa cannot be loaded: ") + (why ? why : "unknown reason"), kRemedy);
    }
    OsMesa mesa;
    const auto resolve = [&]<typename F>(F& function, const char* name) {
        function = reinterpret_cast<F>(::dlsym(library, name));
        if (!function) throw InputError("OpenGL", std::string("libOSMesa has no function ") + name, kRemedy);
    };
    resolve(mesa.createContextAttribs, "OSMesaCreateContextAttribs");
    resolve(mesa.destroyContext, "OSMesaDestroyContext");
    resolve(mesa.getCurrentContext, "OSMesaGetCurrentContext");
    resolve(mesa.makeCurrent, "OSMesaMakeCurrent");
    resolve(mesa.getProcAddress, "OSMesaGetProcAddress");
    return mesa;
}

const OsMesa& osMesa() {
    static const OsMesa kMesa = openOsMesa();
    return kMesa;
}

GlProc osMesaProc(const char* name) { return osMesa().getProcAddress(name); }

// Exceptions must not pass through OpenGL's frames: the message is kept for check(). The compiler's warnings
// are errors of high severity to some drivers, so that only the type tells.
void APIENTRY keepMessage(GLenum, GLenum type, GLuint, GLenum, GLsizei, const GLchar* message,
                          const void* user) {
    auto& kept = *const_cast<std::string*>(static_cast<const std::string*>(user));
    if (type != GL_DEBUG_TYPE_ERROR) return;
    if (kept.size() < 500) kept += (kept.empty() ? "" : " | ") + std::string(message);
}

const char* errorName(GLenum error) {
    switch (error) {
        case GL_INVALID_ENUM:
            return "invalid enum";
        case GL_INVALID_VALUE:
            return "invalid value";
        case GL_INVALID_OPERATION:
            return "invalid operation";
        case GL_INVALID_FRAMEBUFFER_OPERATION:
            return "invalid framebuffer operation";
        case GL_OUT_OF_MEMORY:
            return "out of memory";
        default:
            return "unknown error";
    }
}

}  // namespace

GlFunctions loadGlFunctions(GlProc (*getProc)(const char* name)) {
    GlFunctions gl;
    const char* missing = nullptr;
#define PRT_GL_RESOLVE(type, name)                         \
    gl.name = reinterpret_cast<type>(getProc("gl" #name)); \
    if (!gl.name && !missing) missing = "gl" #name;
    PRT_GL_FUNCTIONS(PRT_GL_RESOLVE)
#undef PRT_GL_RESOLVE
    if (missing)
        throw InputError("OpenGL", std::string("the driver has no function ") + missing,
                         "OpenGL 4.5 is needed");
    return gl;
}

struct GlContext::State {
    OSMesaContext context = nullptr;
    uint32_t pixel = 0;  // OSMesa insists on a buffer; frames are drawn into framebuffer objects
    GlFunctions gl;
    std::string message;

    ~State() {
        if (!context) return;
        if (osMesa().getCurrentContext() == context) osMesa().makeCurrent(nullptr, nullptr, 0, 0, 0);
        osMesa().destroyContext(context);
    }
};

GlContext::GlContext() : state_(std::make_unique<State>()) {
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
    state_->context = osMesa().createContextAttribs(attributes, nullptr);
    if (!state_->context)
        throw InputError("OpenGL", "libOSMesa makes no OpenGL 4.5 core context",
                         "Mesa 22.3 or newer is needed, as in Debian 12");
    makeCurrent();
    state_->gl = loadGlFunctions(osMesaProc);

    // OSMesaGetProcAddress answers any name, so the version has to say what is really there.
    const auto* version = reinterpret_cast<const char*>(gl().GetString(GL_VERSION));
    int major = 0, minor = 0;
    if (!version || std::sscanf(version, "%d.%d", &major, &minor) != 2 || major * 10 + minor < 45)
        throw InputError("OpenGL", std::string("version ") + (version ? version : "unknown") + " is too old",
                         "OpenGL 4.5 is needed (Mesa 22.3, as in Debian 12)");
    gl().DebugMessageCallback(keepMessage, &state_->message);
    gl().Enable(GL_DEBUG_OUTPUT);
    gl().Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    check("creating the context");
}

GlContext::~GlContext() = default;

const GlFunctions& GlContext::gl() const { return state_->gl; }

std::string GlContext::rendererName() const {
    makeCurrent();
    return reinterpret_cast<const char*>(gl().GetString(GL_RENDERER));
}

void GlContext::makeCurrent() const {
    if (osMesa().getCurrentContext() == state_->context) return;
    if (!osMesa().makeCurrent(state_->context, &state_->pixel, GL_UNSIGNED_BYTE, 1, 1))
        throw Error("OpenGL", "the context cannot be made current");
}

void GlContext::check(const std::string& doing) const {
    GLenum first = GL_NO_ERROR;
    // Bounded, because a lost context reports errors without end.
    for (int i = 0; i < 16; ++i) {
        const GLenum error = gl().GetError();
        if (error == GL_NO_ERROR) break;
        if (first == GL_NO_ERROR) first = error;
    }
    const std::string message = std::exchange(state_->message, {});
    if (first == GL_OUT_OF_MEMORY)
        throw InputError("OpenGL", doing + ": out of memory" + (message.empty() ? "" : ": " + message),
                         "use fewer texels, a lower order, smaller tables or a smaller image");
    if (first != GL_NO_ERROR)
        throw Error("OpenGL", doing + ": " + errorName(first) + (message.empty() ? "" : ": " + message));
    if (!message.empty()) throw Error("OpenGL", doing + ": " + message);
}

}  // namespace prt
