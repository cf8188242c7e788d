#include "own_egl.h"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

namespace prt::test {

struct OwnEgl::Functions {
    void* library = ::dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    template <typename F>
    F* get(const char* name) const {
        return library ? reinterpret_cast<F*>(::dlsym(library, name)) : nullptr;
    }
};

std::unique_ptr<OwnEgl> OwnEgl::make() {
    std::unique_ptr<OwnEgl> own(new OwnEgl);
    own->egl_ = std::make_unique<Functions>();
    const Functions& egl = *own->egl_;
    const auto getPlatformDisplay = egl.get<decltype(eglGetPlatformDisplay)>("eglGetPlatformDisplay");
    if (!getPlatformDisplay) return nullptr;
    own->display_ = getPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    if (!own->display_ || !egl.get<decltype(eglInitialize)>("eglInitialize")(own->display_, nullptr, nullptr))
        return nullptr;
    egl.get<decltype(eglBindAPI)>("eglBindAPI")(EGL_OPENGL_API);
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
    own->context_ = egl.get<decltype(eglCreateContext)>("eglCreateContext")(own->display_, nullptr,
                                                                            EGL_NO_CONTEXT, attributes);
    if (!own->context_) return nullptr;
    own->makeCurrent();
    return own;
}

OwnEgl::~OwnEgl() {
    if (!context_) return;
    if (isCurrent()) release();
    egl_->get<decltype(eglDestroyContext)>("eglDestroyContext")(display_, context_);
}

void OwnEgl::release() const {
    egl_->get<decltype(eglMakeCurrent)>("eglMakeCurrent")(display_, nullptr, nullptr, nullptr);
}

void OwnEgl::makeCurrent() const {
    release();
    egl_->get<decltype(eglMakeCurrent)>("eglMakeCurrent")(display_, nullptr, nullptr, context_);
}

bool OwnEgl::isCurrent() const {
    return egl_->get<decltype(eglGetCurrentContext)>("eglGetCurrentContext")() == context_;
}

GlGetProc OwnEgl::getProc() const { return egl_->get<GlProc(const char*)>("eglGetProcAddress"); }

GlProc osMesaProc(const char* name) {
    void* library = ::dlopen("libOSMesa.so.8", RTLD_LAZY | RTLD_NOLOAD);
    return reinterpret_cast<GlGetProc>(::dlsym(library, "OSMesaGetProcAddress"))(name);
}

}  // namespace prt::test
