// How the program was built, read from it.
#include <elf.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace touchdown {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// The program's headers and what its dynamic section says.
class Program : public ::testing::Test {
 protected:
  Program() {
    header_ = At<Elf64_Ehdr>(0);
    for (std::size_t i = 0; i < header_.e_phnum; ++i) {
      segments_.push_back(
          At<Elf64_Phdr>(header_.e_phoff + i * header_.e_phentsize));
    }
    std::size_t strings = 0;
    for (const Elf64_Phdr& segment : segments_) {
      if (segment.p_type != PT_DYNAMIC) continue;
      for (std::size_t i = 0; i < segment.p_filesz / sizeof(Elf64_Dyn); ++i) {
        dynamic_.push_back(
            At<Elf64_Dyn>(segment.p_offset + i * sizeof(Elf64_Dyn)));
        if (dynamic_.back().d_tag == DT_STRTAB) {
          strings = FindOffset(dynamic_.back().d_un.d_ptr);
        }
      }
    }
    for (const Elf64_Dyn& entry : dynamic_) {
      if (entry.d_tag == DT_NEEDED) {
        libraries_.insert(file_.c_str() + strings + entry.d_un.d_val);
      }
    }
  }

  template <class T>
  T At(std::size_t offset) const {
    T value{};
    if (offset + sizeof value > file_.size()) {
      ADD_FAILURE() << "no such byte: " << offset;
      return value;
    }
    std::memcpy(&value, file_.data() + offset, sizeof value);
    return value;
  }
  std::size_t FindOffset(std::size_t address) const {
    for (const Elf64_Phdr& segment : segments_) {
      if (segment.p_type == PT_LOAD && address >= segment.p_vaddr &&
          address < segment.p_vaddr + segment.p_filesz) {
        return address - segment.p_vaddr + segment.p_offset;
      }
    }
    ADD_FAILURE() << "no such address: " << address;
    return 0;
  }
  std::size_t Value(Elf64_Sxword tag) const {
    for (const Elf64_Dyn& entry : dynamic_) {
      if (entry.d_tag == tag) return entry.d_un.d_val;
    }
    return 0;
  }
  const Elf64_Phdr* Segment(Elf64_Word type) const {
    for (const Elf64_Phdr& segment : segments_) {
      if (segment.p_type == type) return &segment;
    }
    return nullptr;
  }

  // A function of ours that others can call.
  struct Function {
    std::string name;
    std::string_view code;
  };
  // From the table of symbols, which a program has until it is stripped.
  std::vector<Function> OurFunctions() const {
    std::vector<Elf64_Shdr> sections;
    for (std::size_t i = 0; i < header_.e_shnum; ++i) {
      sections.push_back(
          At<Elf64_Shdr>(header_.e_shoff + i * header_.e_shentsize));
    }
    std::vector<Function> functions;
    for (const Elf64_Shdr& section : sections) {
      if (section.sh_type != SHT_SYMTAB) continue;
      const std::size_t names = sections.at(section.sh_link).sh_offset;
      for (std::size_t i = 0; i < section.sh_size / sizeof(Elf64_Sym); ++i) {
        const auto symbol =
            At<Elf64_Sym>(section.sh_offset + i * sizeof(Elf64_Sym));
        const std::string name = file_.c_str() + names + symbol.st_name;
        // Mangled: a name in our namespace.
        if (ELF64_ST_TYPE(symbol.st_info) == STT_FUNC &&
            ELF64_ST_BIND(symbol.st_info) == STB_GLOBAL && symbol.st_size > 0 &&
            name.starts_with("_ZN9touchdown")) {
          functions.push_back(
              {name, std::string_view(file_).substr(FindOffset(symbol.st_value),
                                                    symbol.st_size)});
        }
      }
    }
    return functions;
  }

  const std::string file_ = testing::ReadAll(TOUCHDOWN_BINARY);
  Elf64_Ehdr header_{};
  std::vector<Elf64_Phdr> segments_;
  std::vector<Elf64_Dyn> dynamic_;
  std::set<std::string> libraries_;
};

TEST_F(Program, LiesAtAddressesThatNobodyKnows) {
  EXPECT_EQ(header_.e_type, ET_DYN);
  EXPECT_TRUE(Value(DT_FLAGS_1) & DF_1_PIE);
}

TEST_F(Program, HasTablesThatCannotBeOverwritten) {
  EXPECT_NE(Segment(PT_GNU_RELRO), nullptr);
  EXPECT_TRUE((Value(DT_FLAGS) & DF_BIND_NOW) != 0 ||
              (Value(DT_FLAGS_1) & DF_1_NOW) != 0);
}

TEST_F(Program, ExecutesNoStackAndNothingThatCanBeWritten) {
  ASSERT_NE(Segment(PT_GNU_STACK), nullptr);
  EXPECT_FALSE(Segment(PT_GNU_STACK)->p_flags & PF_X);
  for (const Elf64_Phdr& segment : segments_) {
    EXPECT_NE(segment.p_flags & (PF_W | PF_X), Elf64_Word{PF_W | PF_X});
  }
}

TEST_F(Program, LooksForLibrariesWhereTheSystemHasThem) {
  EXPECT_EQ(Value(DT_RPATH), 0u);
  EXPECT_EQ(Value(DT_RUNPATH), 0u);
}

TEST_F(Program, TakesReadersFromTheSystem) {
#ifdef TOUCHDOWN_STATIC_READERS
  GTEST_SKIP() << "built with TOUCHDOWN_STATIC_READERS";
#endif
  EXPECT_THAT(libraries_, Contains("libtiff.so.6"));
  EXPECT_THAT(libraries_, Contains("libsqlite3.so.0"));
  // What libtiff's archive says of the format that libjbig decodes.
  EXPECT_EQ(file_.find("JBIGCopyEncodedData"), std::string::npos);
}

#ifdef TOUCHDOWN_HARDENED

#ifdef __x86_64__
TEST_F(Program, IsJumpedToWhereItsFunctionsBegin) {
  using namespace std::string_view_literals;
  std::vector<std::string> unmarked;
  const auto functions = OurFunctions();
  ASSERT_THAT(functions, SizeIs(::testing::Gt(100u)));
  for (const Function& function : functions) {
    if (!function.code.starts_with("\xf3\x0f\x1e\xfa"sv)) {  // endbr64
      unmarked.push_back(function.name);
    }
  }
  EXPECT_THAT(unmarked, IsEmpty());
}

TEST_F(Program, ChecksItsStack) {
  using namespace std::string_view_literals;
  // %fs:0x28, where the number is that a frame on the stack must keep.
  constexpr auto kGuard = "\x25\x28\x00\x00\x00"sv;
  std::size_t checked = 0;
  for (const Function& function : OurFunctions()) {
    checked += function.code.find(kGuard) != std::string_view::npos ? 1 : 0;
  }
  EXPECT_GT(checked, 100u);
}
#endif

// What the binary cannot tell apart from its archives, which Debian builds with
// it: the flags are those of the whole build.
TEST(Build, ChecksBuffers) {
#ifndef __SSP_STRONG__
  ADD_FAILURE() << "no -fstack-protector-strong";
#endif
#if !defined(_FORTIFY_SOURCE) || _FORTIFY_SOURCE < 2
  ADD_FAILURE() << "no -D_FORTIFY_SOURCE=2";
#endif
#if defined(__x86_64__) && !defined(__CET__)
  ADD_FAILURE() << "no -fcf-protection";
#endif
}

#endif  // TOUCHDOWN_HARDENED

}  // namespace
}  // namespace touchdown
