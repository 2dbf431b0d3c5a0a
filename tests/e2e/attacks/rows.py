"""The attacks, each the row of a table."""

from attacks import jobs
from attacks.attacker import Attack


def attacks():
    drip = {"n": 1024, "duration_s": 40.0, "drip_s": 8.0, "joined": True}
    return [
        Attack("C1", "12 estimates of `UD` at level 10 and 11, clients gone after 1 s", jobs.open_dual, 12,
               path="/v1/estimate", patience_s=1.0),
        Attack("C2", "500 times a glTF of 999,999 rows without bytes", jobs.zeros, 16, detached=True, total=500, duration_s=60.0),
        Attack("C3", "24 bodies of 4 MiB of glTF nodes at once", jobs.nodes, 24),
        Attack("H1 drip", "1,024 bodies of which a byte comes every 8 s", jobs.small, held=200, **drip),
        Attack("H1 hold", "1,024 bodies of 4 MB, 1,000 bytes short", jobs.nodes, held=1000, **drip),
        Attack("H1 join", "1,024 wait for one slow picture", jobs.slow_picture, 1024, joined=True, duration_s=40.0),
        Attack("H2", "598 jobs of 0.3 s that nobody waits for", lambda i: jobs.cube(i, "catmull-clark", 8, "stats"), 8,
               detached=True, total=598),
        Attack("H3", "stacked quads, a face of 100,000 corners, valence 10,000", jobs.badly_forecast(), 6, duration_s=45.0),
        Attack("H4", "a disk whose fsync takes 1 s more", jobs.small, 16, slow_disk=True),
        Attack("H5", "tolerance 0.05 of a cube with a corner at 1e6, clients gone after 1 s", jobs.searched, 4, patience_s=1.0),
    ]
