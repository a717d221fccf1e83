// A file without a room: a planted breach.
