"""Composes labelled pictures into one sheet."""
import dataclasses

from PIL import Image, ImageDraw, ImageFont

FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"
MARGIN, LABEL = 8, 24


@dataclasses.dataclass
class Row:
    title: str
    cells: list  # of (file, label)


def compose(rows, destination):
    """Writes one PNG with a row of equally wide pictures per Row."""
    pictures = [[Image.open(file).convert("RGB") for file, _ in row.cells] for row in rows]
    width = max(p.width for line in pictures for p in line)
    height = max(p.height for line in pictures for p in line)
    columns = max(len(line) for line in pictures)
    line_height = height + 2 * LABEL + MARGIN
    sheet = Image.new("RGB", (columns * (width + MARGIN) + MARGIN, len(rows) * line_height + MARGIN), (32, 32, 34))
    draw = ImageDraw.Draw(sheet)
    title_font, font = ImageFont.truetype(FONT, 16), ImageFont.truetype(FONT, 13)
    for r, (row, line) in enumerate(zip(rows, pictures)):
        y = MARGIN + r * line_height
        draw.text((MARGIN, y), row.title, font=title_font, fill=(240, 240, 240))
        for c, (picture, (_, label)) in enumerate(zip(line, row.cells)):
            x = MARGIN + c * (width + MARGIN)
            sheet.paste(picture, (x, y + LABEL))
            draw.text((x, y + LABEL + picture.height + 3), label, font=font, fill=(200, 200, 200))
    sheet.save(destination, optimize=True)


def strip(files, destination, width):
    """Writes a JPEG of pictures side by side, each averaged down to a width."""
    pictures = [Image.open(file).convert("RGB") for file in files]
    pictures = [p.resize((width, p.height * width // p.width), Image.Resampling.BOX) for p in pictures]
    sheet = Image.new("RGB", (sum(p.width + 4 for p in pictures) - 4, pictures[0].height), (255, 255, 255))
    for i, picture in enumerate(pictures):
        sheet.paste(picture, (i * (width + 4), 0))
    sheet.save(destination, quality=88)
