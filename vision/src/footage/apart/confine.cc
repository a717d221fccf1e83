#include "footage/apart/confine.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <malloc.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <system_error>
#include <vector>

namespace touchdown::vision {
namespace {

std::string ErrorWords() { return std::strerror(errno); }

// Lowers a resource limit; it is never raised.
void Lower(int what, rlim_t most) {
  rlimit limit = {};
  if (getrlimit(what, &limit) != 0) return;
  limit.rlim_max = std::min(limit.rlim_max, most);
  limit.rlim_cur = std::min(limit.rlim_cur, limit.rlim_max);
  setrlimit(what, &limit);
}

// --- Landlock ----------------------------------------------------------------

// Allows kinds of access to a file or folder, and to what is below it.
bool Allow(int rules, const std::filesystem::path& path, std::uint64_t what) {
  landlock_path_beneath_attr rule = {};
  rule.allowed_access = what;
  rule.parent_fd = open(path.c_str(), O_PATH | O_CLOEXEC);
  if (rule.parent_fd < 0) return false;
  const long added = syscall(SYS_landlock_add_rule, rules,
                             LANDLOCK_RULE_PATH_BENEATH, &rule, 0u);
  close(rule.parent_fd);
  return added == 0;
}

// A folder of images may hold links to files elsewhere: each of those is
// allowed by itself.
bool AllowFolder(int rules, const std::filesystem::path& folder) {
  if (!Allow(rules, folder,
             LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR)) {
    return false;
  }
  std::error_code ignored;
  for (const auto& entry :
       std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.is_symlink(ignored) && entry.is_regular_file(ignored)) {
      Allow(rules, entry.path(), LANDLOCK_ACCESS_FS_READ_FILE);
    }
  }
  return true;
}

// --- seccomp -----------------------------------------------------------------

// The architecture whose call numbers the filter knows; 0: none is applied.
#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;  // see above
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;  // see above
#else
constexpr std::uint32_t kArchitecture = 0;  // not written for this processor
#endif

// A refused call fails with EPERM, as if the user had no right to it: libraries
// then go on or give up in an orderly way, where a signal would end the reader.
constexpr std::uint32_t kRefuse = SECCOMP_RET_ERRNO | EPERM;

// Calls that a reader makes, whatever their arguments.
constexpr int kAllowed[] = {
    SYS_read,
    SYS_readv,
    SYS_pread64,
    SYS_preadv,
    SYS_write,
    SYS_writev,
    SYS_close,
    SYS_fstat,
    SYS_newfstatat,
    SYS_statx,
    SYS_lseek,
    SYS_mmap,
    SYS_mprotect,
    SYS_munmap,
    SYS_mremap,
    SYS_madvise,
    SYS_brk,
    SYS_faccessat,
    SYS_faccessat2,
    SYS_readlinkat,
    SYS_getdents64,
    SYS_rt_sigaction,
    SYS_rt_sigprocmask,
    SYS_rt_sigreturn,
    SYS_sigaltstack,
    SYS_futex,
    SYS_set_robust_list,
    SYS_rseq,
    SYS_sched_yield,
    SYS_sched_getaffinity,
    SYS_gettid,
    SYS_getpid,
    SYS_getuid,
    SYS_geteuid,
    SYS_getgid,
    SYS_getegid,
    SYS_clock_gettime,
    SYS_clock_nanosleep,
    SYS_nanosleep,
    SYS_gettimeofday,
    SYS_exit,
    SYS_exit_group,
    SYS_getrandom,
    SYS_memfd_create,
    SYS_ftruncate,
    SYS_fcntl,
    SYS_sendmsg,
    SYS_recvmsg,
    SYS_sendto,
    SYS_recvfrom,
    SYS_ppoll,
    SYS_shutdown,
    SYS_restart_syscall,
    SYS_dup,
    SYS_sysinfo,
    SYS_uname,
    SYS_fadvise64,
#if defined(__x86_64__)
    SYS_stat,
    SYS_lstat,
    SYS_access,
    SYS_readlink,
    SYS_poll,
    SYS_time,
#endif
#ifdef __SANITIZE_ADDRESS__
    // How the sanitizers look whether there is memory at an address.
    SYS_pipe2,
#ifdef SYS_pipe
    SYS_pipe,
#endif
#endif
};

// A filter, call by call: `load` what is compared, `allow` where it fits.
class Filter {
 public:
  Filter() {
    Load(offsetof(seccomp_data, arch));
    // Numbers of another architecture's calls mean other calls.
    Add(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
    Return(kRefuse);
  }
  void Allow(int call) {
    LoadCall();
    Add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1);
    Return(SECCOMP_RET_ALLOW);
  }
  void Answer(int call, int error) {
    LoadCall();
    Add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1);
    Return(SECCOMP_RET_ERRNO | static_cast<std::uint32_t>(error));
  }
  // Where (argument & mask) == value, in its lower half.
  void AllowWhere(int call, int argument, std::uint32_t mask,
                  std::uint32_t value) {
    LoadCall();
    Add(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 4);
    Load(offsetof(seccomp_data, args) +
         static_cast<std::size_t>(argument) * sizeof(std::uint64_t));
    Add(BPF_ALU | BPF_AND | BPF_K, mask, 0, 0);
    Add(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1);
    Return(SECCOMP_RET_ALLOW);
  }
  // Ends the program with refusal, and applies it to this thread and those it
  // starts.
  bool Apply() {
    Return(kRefuse);
    const sock_fprog program = {
        static_cast<unsigned short>(instructions_.size()),
        instructions_.data()};
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
  }

 private:
  void Add(int code, std::uint32_t k, int if_true, int if_false) {
    instructions_.push_back({static_cast<std::uint16_t>(code),
                             static_cast<std::uint8_t>(if_true),
                             static_cast<std::uint8_t>(if_false), k});
  }
  void Load(std::size_t offset) {
    Add(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset), 0, 0);
  }
  void LoadCall() { Load(offsetof(seccomp_data, nr)); }
  void Return(std::uint32_t what) { Add(BPF_RET | BPF_K, what, 0, 0); }

  std::vector<sock_filter> instructions_;
};

}  // namespace

void Limit(const ReaderLimits& limits) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  // Sanitizers take address space without end.
  Lower(RLIMIT_AS, limits.memory_bytes);
#endif
  Lower(RLIMIT_NOFILE, limits.open_files);
  Lower(RLIMIT_CORE, 0);
  // The memory that frames lie in is a file to the kernel, but on no disk: the
  // limit of files is lifted as far as it may be. Beyond it growing fails, and
  // no signal ends the reader.
  rlimit files = {};
  if (getrlimit(RLIMIT_FSIZE, &files) == 0) {
    files.rlim_cur = files.rlim_max;
    setrlimit(RLIMIT_FSIZE, &files);
  }
  std::signal(SIGXFSZ, SIG_IGN);
  // Each arena of malloc takes 64 MiB of address space, and there would be
  // eight for each core.
  mallopt(M_ARENA_MAX, 4);
}

std::string ConfineToFile(const std::filesystem::path& path) {
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0u,
                               LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 1) return ErrorWords();
  // All that the kernel knows to refuse: 13 rights, later 14 and 15.
  constexpr int kRights[] = {13, 14, 15};
  landlock_ruleset_attr attributes = {};
  attributes.handled_access_fs =
      (std::uint64_t{1} << kRights[std::min(version, 3L) - 1]) - 1;
  const int rules = static_cast<int>(
      syscall(SYS_landlock_create_ruleset, &attributes, sizeof attributes, 0u));
  if (rules < 0) return ErrorWords();
  std::error_code ignored;
  const bool allowed = std::filesystem::is_directory(path, ignored)
                           ? AllowFolder(rules, path)
                           : Allow(rules, path, LANDLOCK_ACCESS_FS_READ_FILE);
  const bool confined = allowed &&
                        prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                        syscall(SYS_landlock_restrict_self, rules, 0u) == 0;
  std::string trouble = confined ? "" : ErrorWords();
  close(rules);
  return trouble;
}

std::string ConfineCalls() {
  if (kArchitecture == 0) return "not known for this processor";
  Filter filter;
  for (const int call : kAllowed) filter.Allow(call);
  // Flags of open that ask for more than reading.
  constexpr std::uint32_t kWrites =
      O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;
  filter.AllowWhere(SYS_openat, 2, kWrites, 0);
#if defined(__x86_64__)
  filter.AllowWhere(SYS_open, 1, kWrites, 0);
#endif
  filter.AllowWhere(SYS_socketpair, 0, ~0u, AF_UNIX);
  filter.AllowWhere(SYS_clone, 0, CLONE_THREAD | CLONE_VM,
                    CLONE_THREAD | CLONE_VM);
  // Its flags are in memory, where a filter cannot look; glibc then uses clone.
  filter.Answer(SYS_clone3, ENOSYS);
  // How abort() ends this process.
  filter.AllowWhere(SYS_tgkill, 0, ~0u, static_cast<std::uint32_t>(getpid()));
  filter.AllowWhere(SYS_prctl, 0, ~0u, PR_SET_NAME);
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0 || !filter.Apply()) {
    return ErrorWords();
  }
  return "";
}

}  // namespace touchdown::vision
