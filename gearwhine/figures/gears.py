"""x"""


def draw_gear_pairs(folder, pairs, progress):
    return []
