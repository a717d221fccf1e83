"""Answers where nobody stated the body's size; for `strangers`.

usage: strangers_unstated.py GENERATORS BINARY CLIPS JOBS FOLDER...
CLIPS scenes, spread evenly over the folders, one clip each, formats in turn
(strangers_misstated.py), are analysed without the size that the generators
state. The table is drawn by score.py of the folder GENERATORS.

The exit status is 1, and stderr says why, where a state is wrong, or where the
99.9 % band (Wilson's) of the share of values beyond 4 u lies wholly above 2 in
100, or that of values within 1.96 u wholly below 0.9.
"""
import multiprocessing.pool
import os
import subprocess
import sys
import types

import strangers_misstated

SIZE_OPTIONS = ('--diameter-mm', '--sides-mm')
MOST_BEYOND = 0.02
LEAST_WITHIN = 0.9


def run_unstated(command, **options):
    """subprocess.run of a command without the options of a size and their values."""
    kept = [word for i, word in enumerate(command)
            if word not in SIZE_OPTIONS and (i == 0 or command[i - 1] not in SIZE_OPTIONS)]
    return subprocess.run(kept, **options)


def main():
    generators, binary, count, jobs, *folders = sys.argv[1:]
    sys.path.insert(0, generators)
    import score
    score.subprocess = types.SimpleNamespace(run=run_unstated, TimeoutExpired=subprocess.TimeoutExpired)

    def analyse(job):
        scene, truth, clip = job
        return score.analyse(binary, clip, scene, truth) | dict(scene=os.path.basename(clip))

    with multiprocessing.pool.ThreadPool(int(jobs)) as pool:  # the programs compute, not Python
        rows = pool.map(analyse, strangers_misstated.clips_of(folders, int(count)), chunksize=1)
    print('\n## No size stated\n\n```', end='')
    score.table('formats in turn', rows)
    print('```')
    z = [abs(row[quantity]) / row[quantity + '_u'] for row in rows for quantity, *_ in score.QUANTITIES
         if row.get(quantity) is not None]
    within = sum(value <= 1.96 for value in z)
    beyond = sum(value > 4 for value in z)
    print(f'\nOf {len(z)} values {within} lie within 1.96 u, {beyond} beyond 4 u.')
    band = strangers_misstated.NORMAL_9995
    faults = [f"the state of {row['scene']} is wrong" for row in rows if score.state(row) == 'wrong']
    if score.wilson(beyond, len(z), band)[0] > MOST_BEYOND:
        faults.append(f'{beyond} of {len(z)} values lie beyond 4 u')
    if score.wilson(within, len(z), band)[1] < LEAST_WITHIN:
        faults.append(f'{within} of {len(z)} values lie within 1.96 u')
    for fault in faults:
        print(f'bench: strangers: no size stated: {fault}', file=sys.stderr)
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
