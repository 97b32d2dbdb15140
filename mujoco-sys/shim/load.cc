// The XML loader and saver. They are C++ inside: they throw (std::bad_alloc at least), they hold a lock while they parse, they
// switch the thread's locale, and they install an error handler of their own that they forget when they throw. All of that is
// put back here. An engine error that reaches the handler of the guard has jumped over the release of the parser's lock, so
// after MUJOCO_SYS_ERROR the next load would wait for ever: the caller must refuse to make it.
#include <clocale>
#include <exception>
#include <new>

#if defined(__APPLE__)
#include <xlocale.h>
#endif

#include "guard.h"

extern "C" {
// Not in the headers, and gone in the newer engines: hence weak.
typedef void (*mujoco_sys_handler)(const char*);
__attribute__((weak)) mujoco_sys_handler _mjPRIVATE__get_tls_error_fn(void);
__attribute__((weak)) void _mjPRIVATE__set_tls_error_fn(mujoco_sys_handler);
__attribute__((weak)) mujoco_sys_handler _mjPRIVATE__get_tls_warning_fn(void);
__attribute__((weak)) void _mjPRIVATE__set_tls_warning_fn(mujoco_sys_handler);
// The number of significant digits that the XML writer prints, per thread. 6 unless set.
__attribute__((weak)) int _mjPRIVATE__get_xml_precision(void);
__attribute__((weak)) void _mjPRIVATE__set_xml_precision(int);
}

namespace {

// What the loader may leave changed in the thread.
struct ThreadState {
  locale_t locale = uselocale(static_cast<locale_t>(0));
  mujoco_sys_guard* guard = *mujoco_sys_innermost();
  mujoco_sys_handler error = _mjPRIVATE__get_tls_error_fn ? _mjPRIVATE__get_tls_error_fn() : nullptr;
  mujoco_sys_handler warning = _mjPRIVATE__get_tls_warning_fn ? _mjPRIVATE__get_tls_warning_fn() : nullptr;

  void restore() const {
    uselocale(locale);
    *mujoco_sys_innermost() = guard;
    if (_mjPRIVATE__set_tls_error_fn) _mjPRIVATE__set_tls_error_fn(error);
    if (_mjPRIVATE__set_tls_warning_fn) _mjPRIVATE__set_tls_warning_fn(warning);
  }
};

// Runs `call` with the guard set. No object with a destructor lives in a frame that the jump leaves on this side.
template <typename Call>
int run(Call call) {
  const ThreadState before;
  mujoco_sys_guard guard;
  guard.outer = before.guard;
  if (MUJOCO_SYS_SET_MARK(guard.return_to)) {
    before.restore();
    return MUJOCO_SYS_ERROR;
  }
  *mujoco_sys_innermost() = &guard;
  int status = MUJOCO_SYS_OK;
  try {
    call();
  } catch (const std::bad_alloc&) {
    mujoco_sys_set_message("out of memory");
    status = MUJOCO_SYS_OUT_OF_MEMORY;
  } catch (const std::exception& exception) {
    mujoco_sys_set_message(exception.what());
    status = MUJOCO_SYS_EXCEPTION;
  } catch (...) {
    mujoco_sys_set_message("an exception of an unknown type");
    status = MUJOCO_SYS_EXCEPTION;
  }
  before.restore();
  return status;
}

}  // namespace

extern "C" {

int mujoco_sys_mj_loadXML(const char* filename, const mjVFS* vfs, char* error, int error_size, mjModel** result) {
  return run([=] { *result = mj_loadXML(filename, vfs, error, error_size); });
}

int mujoco_sys_xml_digits(void) {
  const bool adjustable = _mjPRIVATE__get_xml_precision && _mjPRIVATE__set_xml_precision;
  return adjustable ? 17 : 6;
}

// Prints every digit that a double has, where the engine lets the precision be set.
int mujoco_sys_mj_saveLastXML(const char* filename, const mjModel* m, char* error, int error_size, int* result) {
  const bool adjustable = _mjPRIVATE__get_xml_precision && _mjPRIVATE__set_xml_precision;
  const int before = adjustable ? _mjPRIVATE__get_xml_precision() : 0;
  if (adjustable) _mjPRIVATE__set_xml_precision(mujoco_sys_xml_digits());
  const int status = run([=] { *result = mj_saveLastXML(filename, m, error, error_size); });
  if (adjustable) _mjPRIVATE__set_xml_precision(before);
  return status;
}

int mujoco_sys_mj_printSchema(const char* filename, char* buffer, int buffer_size, int html, int pad, int* result) {
  return run([=] { *result = mj_printSchema(filename, buffer, buffer_size, html, pad); });
}

}
