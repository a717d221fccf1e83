#include "tests/db/power_loss_disk.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

namespace touchdown::db {
namespace {

constexpr std::size_t kSector = 512;

struct FollowedFile {
  sqlite3_file base;
  sqlite3_file* real;
  PowerLossDisk* disk;
  const char* name;  // nullptr: not followed (temporary files)
};

FollowedFile& Of(sqlite3_file* file) {
  return *reinterpret_cast<FollowedFile*>(file);
}
sqlite3_file* Real(sqlite3_file* file) { return Of(file).real; }

int Close(sqlite3_file* f) { return Real(f)->pMethods->xClose(Real(f)); }
int Read(sqlite3_file* f, void* to, int size, sqlite3_int64 offset) {
  return Real(f)->pMethods->xRead(Real(f), to, size, offset);
}
int Write(sqlite3_file* f, const void* from, int size, sqlite3_int64 offset) {
  const int code = Real(f)->pMethods->xWrite(Real(f), from, size, offset);
  if (code == SQLITE_OK && Of(f).name != nullptr) {
    Of(f).disk->Wrote(Of(f).name, from, static_cast<std::size_t>(size), offset);
  }
  return code;
}
int Truncate(sqlite3_file* f, sqlite3_int64 size) {
  const int code = Real(f)->pMethods->xTruncate(Real(f), size);
  if (code == SQLITE_OK && Of(f).name != nullptr) {
    Of(f).disk->Truncated(Of(f).name, size);
  }
  return code;
}
int Sync(sqlite3_file* f, int) {
  // The real disk need not turn for this test.
  if (Of(f).name != nullptr) Of(f).disk->Synced(Of(f).name);
  return SQLITE_OK;
}
int Size(sqlite3_file* f, sqlite3_int64* size) {
  return Real(f)->pMethods->xFileSize(Real(f), size);
}
int Lock(sqlite3_file* f, int level) {
  return Real(f)->pMethods->xLock(Real(f), level);
}
int Unlock(sqlite3_file* f, int level) {
  return Real(f)->pMethods->xUnlock(Real(f), level);
}
int CheckLock(sqlite3_file* f, int* out) {
  return Real(f)->pMethods->xCheckReservedLock(Real(f), out);
}
int Control(sqlite3_file* f, int op, void* arg) {
  return Real(f)->pMethods->xFileControl(Real(f), op, arg);
}
int SectorSize(sqlite3_file* f) {
  return Real(f)->pMethods->xSectorSize(Real(f));
}
int Characteristics(sqlite3_file* f) {
  return Real(f)->pMethods->xDeviceCharacteristics(Real(f));
}
int ShmMap(sqlite3_file* f, int page, int size, int extend,
           void volatile** out) {
  return Real(f)->pMethods->xShmMap(Real(f), page, size, extend, out);
}
int ShmLock(sqlite3_file* f, int offset, int n, int flags) {
  return Real(f)->pMethods->xShmLock(Real(f), offset, n, flags);
}
void ShmBarrier(sqlite3_file* f) { Real(f)->pMethods->xShmBarrier(Real(f)); }
int ShmUnmap(sqlite3_file* f, int remove) {
  return Real(f)->pMethods->xShmUnmap(Real(f), remove);
}

const sqlite3_io_methods kMethods = {2,
                                     Close,
                                     Read,
                                     Write,
                                     Truncate,
                                     Sync,
                                     Size,
                                     Lock,
                                     Unlock,
                                     CheckLock,
                                     Control,
                                     SectorSize,
                                     Characteristics,
                                     ShmMap,
                                     ShmLock,
                                     ShmBarrier,
                                     ShmUnmap,
                                     nullptr,
                                     nullptr};

PowerLossDisk& DiskOf(sqlite3_vfs* vfs) {
  return *static_cast<PowerLossDisk*>(vfs->pAppData);
}

int Open(sqlite3_vfs* vfs, const char* name, sqlite3_file* out, int flags,
         int* out_flags) {
  PowerLossDisk& disk = DiskOf(vfs);
  FollowedFile& file = Of(out);
  file.base.pMethods = nullptr;
  file.real = reinterpret_cast<sqlite3_file*>(&file + 1);
  file.disk = &disk;
  const bool followed =
      (flags &
       (SQLITE_OPEN_MAIN_DB | SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_WAL)) != 0;
  file.name = followed ? name : nullptr;
  const int code =
      disk.real().xOpen(&disk.real(), name, file.real, flags, out_flags);
  if (file.real->pMethods != nullptr) file.base.pMethods = &kMethods;
  if (code == SQLITE_OK && followed)
    disk.Opened(name, (flags & SQLITE_OPEN_MAIN_DB) == 0);
  return code;
}
int Delete(sqlite3_vfs* vfs, const char* name, int sync_folder) {
  PowerLossDisk& disk = DiskOf(vfs);
  const int code = disk.real().xDelete(&disk.real(), name, 0);
  if (code == SQLITE_OK) disk.Deleted(name, sync_folder != 0);
  return code;
}
int Access(sqlite3_vfs* vfs, const char* name, int flags, int* out) {
  auto& real = DiskOf(vfs).real();
  return real.xAccess(&real, name, flags, out);
}
int FullPath(sqlite3_vfs* vfs, const char* name, int size, char* out) {
  auto& real = DiskOf(vfs).real();
  return real.xFullPathname(&real, name, size, out);
}
int Randomness(sqlite3_vfs* vfs, int size, char* out) {
  auto& real = DiskOf(vfs).real();
  return real.xRandomness(&real, size, out);
}
int Sleep(sqlite3_vfs* vfs, int us) {
  auto& real = DiskOf(vfs).real();
  return real.xSleep(&real, us);
}
int Now(sqlite3_vfs* vfs, double* out) {
  auto& real = DiskOf(vfs).real();
  return real.xCurrentTime(&real, out);
}
int LastError(sqlite3_vfs* vfs, int size, char* out) {
  auto& real = DiskOf(vfs).real();
  return real.xGetLastError(&real, size, out);
}

void Put(Bytes& file, std::int64_t offset, const char* data, std::size_t size) {
  const auto begin = static_cast<std::size_t>(offset);
  if (file.size() < begin + size) file.resize(begin + size);
  std::copy_n(data, size, file.begin() + offset);
}

}  // namespace

PowerLossDisk::PowerLossDisk(std::function<void()> on_write)
    : real_(sqlite3_vfs_find(nullptr)), on_write_(std::move(on_write)) {
  vfs_.iVersion = 1;
  vfs_.szOsFile = static_cast<int>(sizeof(FollowedFile)) + real_->szOsFile;
  vfs_.mxPathname = real_->mxPathname;
  vfs_.zName = "power-loss";
  vfs_.pAppData = this;
  vfs_.xOpen = Open;
  vfs_.xDelete = Delete;
  vfs_.xAccess = Access;
  vfs_.xFullPathname = FullPath;
  vfs_.xRandomness = Randomness;
  vfs_.xSleep = Sleep;
  vfs_.xCurrentTime = Now;
  vfs_.xGetLastError = LastError;
  sqlite3_vfs_register(&vfs_, 1);
}

PowerLossDisk::~PowerLossDisk() {
  sqlite3_vfs_unregister(&vfs_);
  sqlite3_vfs_register(real_, 1);
}

void PowerLossDisk::Opened(const std::string& name, bool is_log) {
  File& file = files_[name];
  if (!file.exists && is_log) file.syncs_folder = true;
  file.exists = true;
}

void PowerLossDisk::Wrote(const std::string& name, const void* data,
                          std::size_t size, std::int64_t offset) {
  const char* bytes = static_cast<const char*>(data);
  // Sector by sector: a disk promises nothing about more.
  auto& pending = files_[name].pending;
  for (std::size_t done = 0; done < size;) {
    const auto at = static_cast<std::size_t>(offset) + done;
    const std::size_t part = std::min(size - done, kSector - at % kSector);
    pending.push_back({static_cast<std::int64_t>(at),
                       Bytes(bytes + done, bytes + done + part), -1});
    done += part;
  }
  on_write_();
}

void PowerLossDisk::Truncated(const std::string& name, std::int64_t size) {
  files_[name].pending.push_back({0, {}, size});
  on_write_();
}

void PowerLossDisk::Synced(const std::string& name) {
  on_write_();  // power may fail just before
  auto& file = files_[name];
  for (const auto& write : file.pending) {
    if (write.truncate_to >= 0) {
      file.synced.resize(static_cast<std::size_t>(write.truncate_to));
    } else {
      Put(file.synced, write.offset, write.data.data(), write.data.size());
    }
  }
  file.pending.clear();
  on_write_();  // or between the file and its folder
  if (file.syncs_folder) {
    file.syncs_folder = false;
    for (auto& [other_name, other] : files_) {
      other.name_synced = other.exists;
      other.has_ghost = false;
    }
    on_write_();
  }
}

void PowerLossDisk::Deleted(const std::string& name, bool folder_synced) {
  File old = std::move(files_[name]);
  File& file = files_[name];
  file = File();
  if (!folder_synced && old.name_synced) {
    file.has_ghost = true;
    file.ghost = std::move(old.synced);
  }
  on_write_();
}

DiskPicture PowerLossDisk::AfterPowerLoss(std::mt19937_64& engine) const {
  const auto coin = [&engine] { return engine() % 2 == 0; };
  DiskPicture picture;
  for (const auto& [name, file] : files_) {
    if (!file.name_synced && coin()) {
      if (file.has_ghost) picture[name] = file.ghost;
      continue;
    }
    if (!file.exists) continue;
    Bytes content = file.synced;
    // Nothing, everything, or any part of what was not synced, in any order.
    const auto mode = engine() % 4;
    auto pending = file.pending;
    if (mode == 0) pending.clear();
    if (mode == 3) std::shuffle(pending.begin(), pending.end(), engine);
    for (std::size_t i = 0; i < pending.size(); ++i) {
      const auto& write = pending[i];
      if (mode >= 2 && coin()) continue;
      if (write.truncate_to >= 0) {
        content.resize(static_cast<std::size_t>(write.truncate_to));
        continue;
      }
      std::size_t size = write.data.size();
      if (mode >= 2 && i + 1 == pending.size()) size = engine() % (size + 1);
      Put(content, write.offset, write.data.data(), size);
    }
    picture[name] = std::move(content);
  }
  return picture;
}

}  // namespace touchdown::db
