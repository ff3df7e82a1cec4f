// What a user can do when the system refuses to write.
#pragma once

#include <cerrno>
#include <string>

namespace burnish {

// The hint for an errno.
inline std::string write_hint(int error) {
  switch (error) {
    case ENOENT: return "make the folder first, or name another";
    case ENOTDIR: return "a part of its path is a file: name another place";
    case EEXIST: return "something of that name is in the way: name another place";
    case EACCES:
    case EPERM:
    case EROFS: return "look at the rights of its folder, or name another place";
    case ENOSPC:
    case EDQUOT:
    case EFBIG: return "free some room, or name another place";
    case EPIPE: return "what was to read it has ended";
    default: return "name another place, such as one on another disk";
  }
}

}  // namespace burnish
