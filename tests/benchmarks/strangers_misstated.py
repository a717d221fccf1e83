"""What becomes of a statement that is wrong; for `strangers`.

usage: strangers_misstated.py GENERATORS BINARY CLIPS JOBS FOLDER...
Of CLIPS scenes, spread evenly over the folders, one clip each, formats in turn,
is analysed once as it is and once with each of the statements below. An answer
is refused where there is no contact, told where the document has a warning more
than with the right statement, and silent otherwise. A silent answer is false
where score.py of the folder GENERATORS calls it gross.

The exit status is 1, and stderr says why, where the 99.9 % band (Wilson's) of
the share of false answers lies wholly above 1 in 100. Statements that few clips
can show do not count: a frame rate needs a flight that shows gravity.
"""
import glob
import json
import multiprocessing.pool
import os
import sys


def resize(scene, factor):
    return scene | {side: scene[side] * factor for side in ('diameter', 'a', 'b') if side in scene}


def change_kind(scene):
    """A ball as the square about it, a block as the ball of its longer side."""
    if scene['shape'] == 'sphere':
        return scene | dict(shape='rectangle', a=scene['diameter'], b=scene['diameter'], face_deg=0.)
    return scene | dict(shape='sphere', diameter=scene['a'])


NORMAL_9995 = 3.2905  # 0.9995 quantile of the normal distribution
MOST_BELIEVED = 0.01

# What is stated, how it is made of the scene, and whether it counts.
STATEMENTS = (
    ('size x 1.2', lambda scene: resize(scene, 1.2), True),
    ('size x 0.85', lambda scene: resize(scene, 0.85), True),
    ('the other kind of body', change_kind, True),
    ('scale x 1.1', lambda scene: scene | dict(scale=scene['scale'] * 1.1), True),
    ('frame rate x 1.2', lambda scene: scene | dict(fps=scene['fps'] * 1.2), False),
)


def lands(truth):
    """Whether the body lands, and not before the film begins: the generators show no other scene."""
    return truth.get('contact_time_s') is not None and truth['contact_frame'] >= 3


def clips_of(folders, count):
    """Scene, truth and clip of `count` scenes, formats in turn."""
    scenes = []
    for folder in folders:
        for path in sorted(glob.glob(f'{folder}/*.truth.json')):
            described = json.load(open(path))
            if lands(described['truth']):
                scenes.append((described['scene'], described['truth'], path.removesuffix('.truth.json')))
    for i, (scene, truth, base) in enumerate(scenes[::max(1, len(scenes) // count)][:count]):
        clips = sorted(path for path in glob.glob(f'{base}[._]*') if path.endswith(('.mraw', '.mp4', '.avi')))
        yield scene, truth, clips[i % len(clips)]


def analyse_clip(score, binary, job):
    """Name of the clip, whether it is answered when stated right, and what becomes of each wrong statement."""
    scene, truth, clip = job
    right = score.analyse(binary, clip, scene, truth)
    fates = []
    for _, state, _ in STATEMENTS:
        row = score.analyse(binary, clip, state(scene), truth)
        if not row['found']:
            fate = 'refused'
        elif row['warnings'] > right.get('warnings', 0):
            fate = 'told'
        else:
            fate = 'false' if score.gross(row) else 'silent'
        fates.append(fate)
    return os.path.relpath(clip, os.path.dirname(os.path.dirname(clip))), right['found'], fates


def main():
    generators, binary, count, jobs, *folders = sys.argv[1:]
    sys.path.insert(0, generators)
    import score

    with multiprocessing.pool.ThreadPool(int(jobs)) as pool:  # the programs compute, not Python
        clips = pool.map(lambda job: analyse_clip(score, binary, job), clips_of(folders, int(count)), chunksize=1)
    print(f'\n## Wrong statements\n\n{len(clips)} clips, of which {sum(found for _, found, _ in clips)} are answered when all is'
          ' stated right. Silent: no warning that the right statement does not bring. False: silent and gross.\n')
    print('| stated | refused | told | silent | of these false |\n|---|---:|---:|---:|---:|')
    counted = believed = 0
    for i, (name, _, counts) in enumerate(STATEMENTS):
        fates = [fates[i] for _, _, fates in clips]
        false = [clip for clip, _, fates in clips if fates[i] == 'false']
        print(f"| {name} | {fates.count('refused')} | {fates.count('told')} | {fates.count('silent') + len(false)} |"
              f" {len(false)} {' '.join(false)} |")
        if counts:
            counted += len(clips)
            believed += len(false)
    if score.wilson(believed, counted, NORMAL_9995)[0] <= MOST_BELIEVED:
        return 0
    print(f'bench: strangers: {believed} of {counted} answers to wrong statements are believed and gross', file=sys.stderr)
    return 1


if __name__ == '__main__':
    sys.exit(main())
