// The XML loader and saver. They are C++ inside: they throw (std::bad_alloc at least), they hold a lock while they parse, they
// switch the thread's locale, and they install an error handler of their own that they forget when they throw. All of that is
// put back here. An engine error that reaches the handler of the guard has jumped over the release of the parser's lock, so
// after MUJOCO_SYS_ERROR the next load would wait for ever: the caller must refuse to make it.
#include <clocale>
#include <cstdio>
#include <cstring>
#include <exception>
#include <mutex>
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

// The convex hull library of the XML compiler prints its errors and warnings to `stderr`, the C library's variable. During a load
// the variable refers to a stream that keeps what the loading thread prints, and passes on what other threads print meanwhile.
thread_local char printed[4096];
thread_local size_t printed_length;
thread_local bool keeps_printed;

#if defined(__GLIBC__)
class CapturedStderr {
 public:
  CapturedStderr() {
    printed_length = 0;
    keeps_printed = true;
    const std::lock_guard<std::mutex> lock(mutex());
    if (loads()++ == 0 && stream()) {
      original() = stderr;
      __atomic_store_n(&stderr, stream(), __ATOMIC_RELEASE);
    }
  }

  // Not a destructor: an engine error jumps over those.
  static void release() {
    keeps_printed = false;
    printed[printed_length] = '\0';
    const std::lock_guard<std::mutex> lock(mutex());
    if (--loads() == 0 && stream()) {
      __atomic_store_n(&stderr, original(), __ATOMIC_RELEASE);
    }
  }

 private:
  static std::mutex& mutex() {
    static std::mutex only;
    return only;
  }

  static int& loads() {
    static int count = 0;
    return count;
  }

  static FILE*& original() {
    static FILE* file = stderr;
    return file;
  }

  // Never closed: another thread may have read the variable during a load.
  static FILE* stream() {
    static FILE* const only = open();
    return only;
  }

  static FILE* open() {
    FILE* const file = fopencookie(nullptr, "w", {nullptr, write, nullptr, nullptr});
    if (file) setvbuf(file, nullptr, _IONBF, 0);
    return file;
  }

  static ssize_t write(void*, const char* text, size_t length) {
    if (!keeps_printed) return static_cast<ssize_t>(fwrite(text, 1, length, original()));
    const size_t room = sizeof(printed) - 1 - printed_length;
    const size_t kept = length < room ? length : room;
    std::memcpy(printed + printed_length, text, kept);
    printed_length += kept;
    return static_cast<ssize_t>(length);
  }
};
#else
struct CapturedStderr {
  static void release() {}
};
#endif

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
  const CapturedStderr captured;
  const int status = run([=] { *result = mj_loadXML(filename, vfs, error, error_size); });
  captured.release();
  return status;
}

const char* mujoco_sys_printed(void) { return printed; }

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
