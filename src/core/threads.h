#pragma once

namespace castray {

/// How many threads this process may keep busy: the processors of its affinity mask, at most what the
/// cgroup's CPU quota (v2 cpu.max or v1 cpu.cfs_quota_us, of its own group or one above) pays for; at
/// least 1.
int available_threads();

}  // namespace castray
