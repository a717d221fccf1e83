"""One table a format of what the generators' seeds gave, pooled; for `strangers`.

usage: strangers_tables.py GENERATORS NAME:SEED:ROWS_FILE...
The tables are drawn by score.py of the folder GENERATORS, as the generators do.
Scenes are named SEED_SCENE. Formats stand in the order of the rows.
"""
import json
import sys


def pool(files):
    """The rows of all seeds, by generator and format, in the order met."""
    pooled = {}
    for file in files:
        generator, seed, path = file.split(':', 2)
        for row in json.load(open(path)):
            row['scene'] = f"{seed}_{row['scene']}"
            pooled.setdefault(generator, {}).setdefault(row['format'], []).append(row)
    return pooled


def main():
    sys.path.insert(0, sys.argv[1])
    import score

    for generator, formats in pool(sys.argv[2:]).items():
        print(f'\n## {generator}.py\n\n```', end='')
        for name, rows in formats.items():
            score.table(name, rows)
        for kind in dict.fromkeys(row['kind'] for row in formats.get('raw', [])):
            score.table(f'raw, {kind}', [row for row in formats['raw'] if row['kind'] == kind])
        print('```')


if __name__ == '__main__':
    main()
