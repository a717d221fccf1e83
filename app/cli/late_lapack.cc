// These are stand-ins for the functions of LAPACK and BLAS that OpenCV's
// archives call: the first call of any of them loads the library. Linked with
// the program, the library and the threads that OpenBLAS starts would cost
// every command milliseconds, and only the calibration of a camera has matrices
// that need it. The archives also ask for three functions of GLX; no display is
// ever opened, so these do nothing.
#include <dlfcn.h>

#include <cstddef>
#include <string>

#include "touchdown/core/errors.h"

namespace {

// Returns the function of that name in liblapack or in what it depends on.
// Throws core::InputError saying which package to install.
void* Find(const char* name) {
  // With the BLAS that it needs. Never closed: it is used to the program's end.
  static void* const library = ::dlopen("liblapack.so.3", RTLD_LAZY);
  void* const found = library != nullptr ? ::dlsym(library, name) : nullptr;
  if (found == nullptr) {
    const char* const reason = ::dlerror();
    throw touchdown::core::InputError(
        "liblapack.so.3: " + std::string(reason != nullptr ? reason : name) +
        "; to calibrate needs it: install liblapack3");
  }
  return found;
}

// Calls the function with the arguments as they came: all are pointers or C
// numbers, so nothing is converted.
template <class... Arguments>
void Late(const char* name, Arguments... arguments) {
  reinterpret_cast<void (*)(Arguments...)>(Find(name))(arguments...);
}

// Fortran passes the length of each text argument behind all others: uplo, jobz
// and trans are one letter long.
constexpr std::size_t kLetter = 1;

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): LAPACK's names
#pragma GCC visibility push(hidden)
extern "C" {

// `t` is s for float or d for double. The parameters stand as LAPACK's manual
// has them; none is read here, so void* serves for all.
#define TOUCHDOWN_LAPACK(t)                                                    \
  void t##getrf_(void* m, void* n, void* a, void* lda, void* ipiv,             \
                 void* info) {                                                 \
    Late(#t "getrf_", m, n, a, lda, ipiv, info);                               \
  }                                                                            \
  void t##potrf_(void* uplo, void* n, void* a, void* lda, void* info) {        \
    Late(#t "potrf_", uplo, n, a, lda, info, kLetter);                         \
  }                                                                            \
  void t##geqrf_(void* m, void* n, void* a, void* lda, void* tau, void* work,  \
                 void* lwork, void* info) {                                    \
    Late(#t "geqrf_", m, n, a, lda, tau, work, lwork, info);                   \
  }                                                                            \
  void t##gesdd_(void* jobz, void* m, void* n, void* a, void* lda, void* s,    \
                 void* u, void* ldu, void* vt, void* ldvt, void* work,         \
                 void* lwork, void* iwork, void* info) {                       \
    Late(#t "gesdd_", jobz, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork,    \
         iwork, info, kLetter);                                                \
  }                                                                            \
  void t##gesv_(void* n, void* nrhs, void* a, void* lda, void* ipiv, void* b,  \
                void* ldb, void* info) {                                       \
    Late(#t "gesv_", n, nrhs, a, lda, ipiv, b, ldb, info);                     \
  }                                                                            \
  void t##posv_(void* uplo, void* n, void* nrhs, void* a, void* lda, void* b,  \
                void* ldb, void* info) {                                       \
    Late(#t "posv_", uplo, n, nrhs, a, lda, b, ldb, info, kLetter);            \
  }                                                                            \
  void t##gels_(void* trans, void* m, void* n, void* nrhs, void* a, void* lda, \
                void* b, void* ldb, void* work, void* lwork, void* info) {     \
    Late(#t "gels_", trans, m, n, nrhs, a, lda, b, ldb, work, lwork, info,     \
         kLetter);                                                             \
  }
TOUCHDOWN_LAPACK(s)
TOUCHDOWN_LAPACK(d)
#undef TOUCHDOWN_LAPACK

// Unlike LAPACK's, the functions of CBLAS take numbers by value; complex
// factors come as pointers.
#define TOUCHDOWN_BLAS(t, Scalar)                                             \
  void cblas_##t##gemm(int order, int trans_a, int trans_b, int m, int n,     \
                       int k, Scalar alpha, const void* a, int lda,           \
                       const void* b, int ldb, Scalar beta, void* c,          \
                       int ldc) {                                             \
    Late("cblas_" #t "gemm", order, trans_a, trans_b, m, n, k, alpha, a, lda, \
         b, ldb, beta, c, ldc);                                               \
  }
TOUCHDOWN_BLAS(s, float)
TOUCHDOWN_BLAS(d, double)
TOUCHDOWN_BLAS(c, const void*)
TOUCHDOWN_BLAS(z, const void*)
#undef TOUCHDOWN_BLAS

void* glXGetProcAddressARB(const void*) { return nullptr; }
void* glXGetCurrentContext() { return nullptr; }
void* glXGetCurrentDisplay() { return nullptr; }

}  // extern "C"
#pragma GCC visibility pop
// NOLINTEND(readability-identifier-naming)
