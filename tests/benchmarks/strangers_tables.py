"""One table a format of what the generators' seeds gave, pooled; for `strangers`.

usage: strangers_tables.py GENERATORS NAME:SEED:ROWS_FILE...
The tables are drawn by score.py of the folder GENERATORS, as the generators do.
Scenes are named SEED_SCENE. Formats stand in the order of the rows.

The exit status is 1, and stderr says why, where a state is wrong, or where the
99.9 % band (Wilson's) of a share lies wholly on the wrong side of what is asked:
values within 1.96 u below 0.95, gross answers above 2 in 480.
"""
import glob
import json
import os
import resource
import subprocess
import sys


def pool(files):
    """The rows of all seeds, by generator and format, in the order met."""
    pooled = {}
    for file in files:
        generator, seed, path = file.split(':', 2)
        for row in json.load(open(path)):
            row['scene'] = f"{seed}_{row['scene']}"
            row['base'] = os.path.join(os.path.dirname(path), f"[cs]{row['scene']}")
            pooled.setdefault(generator, {}).setdefault(row['format'], []).append(row)
    return pooled


def decode(clip, frames=()):
    """Processor time of ffmpeg on a clip, in s: of all frames, or of the first ones."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(['ffmpeg', '-v', 'error', '-threads', '1', '-i', clip, *frames, '-f', 'null', '-'], check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


CLIPS_DECODED = 12  # of a format, evenly spread; more take longer


def decoding_ms(name, rows):
    """What it takes to decode a frame once, in ms; None of a format that is not compressed."""
    spent = frames = 0
    for row in rows[::max(1, len(rows) // CLIPS_DECODED)]:
        clips = glob.glob(f"{row['base']}_{name}.*") or glob.glob(f"{row['base']}.mp4")
        if name == 'raw' or not clips:
            return None
        # Without what the first frame costs: ffmpeg's own start.
        spent += decode(clips[0]) - decode(clips[0], ('-frames:v', '1'))
        frames += row['frames'] - 1
    return 1e3 * spent / frames


NORMAL_9995 = 3.2905  # 0.9995 quantile of the normal distribution


def judge(score, name, rows):
    """What is not as asked, a sentence each."""
    for row in rows:
        if score.state(row) == 'wrong':
            yield f"{name}: the state of scene {row['scene']} is wrong"
    gross = sum(map(score.gross, rows))
    if score.wilson(gross, len(rows), NORMAL_9995)[0] > 2 / 480:
        yield f'{name}: {gross} of {len(rows)} clips are gross'
    for quantity, *_ in score.QUANTITIES:
        told = [row for row in rows if row.get(quantity) is not None]
        held = sum(abs(row[quantity]) <= 1.96 * row[quantity + '_u'] for row in told)
        if score.wilson(held, len(told), NORMAL_9995)[1] < 0.95:
            yield f'{name}: {held} of {len(told)} values of {quantity} lie within 1.96 u'


def main():
    sys.path.insert(0, sys.argv[1])
    import score

    titles = {'other': 'composite.py, other photographs'}
    faults = []
    for generator, formats in pool(sys.argv[2:]).items():
        print(f"\n## {titles.get(generator, generator + '.py')}\n\n```", end='')
        for name, rows in formats.items():
            score.table(name, rows)
            if (once := decoding_ms(name, rows)) is not None:
                print(f'of it to decode a frame once, by ffmpeg: {once:.1f} ms')
            faults += judge(score, f'{generator}, {name}', rows)
        for kind in dict.fromkeys(row['kind'] for row in formats.get('raw', [])):
            score.table(f'raw, {kind}', [row for row in formats['raw'] if row['kind'] == kind])
        print('```')
    for fault in faults:
        print(f'bench: strangers: {fault}', file=sys.stderr)
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
