# The editor of halls. What its script says too stands with the scripts.

halls-title = Hall editor
halls-to-simulator = To the simulator
halls-viewer = You are signed in as a viewer: you see the hall and may press STOP. Everything else needs an operator's key.

## Drawing.

halls-drawing = Drawing
halls-tool = Tool
halls-wall = Wall
halls-floor = Floor
halls-luggage = Luggage
halls-dangerous = Dangerous
halls-home = Home
halls-area = Area
halls-shape = Shape to draw
halls-brush = Brush
halls-line = Line
halls-rectangle = Rectangle
halls-undo = Undo
halls-redo = Redo
halls-drawing-about = Draw with a pointer or a finger. With the keyboard, arrows move the cursor, and space draws; a line or a rectangle needs space twice. <kbd>c</kbd> cancels an unfinished line or rectangle. The letter beside a tool chooses that tool.
halls-plan = Plan of the hall
halls-areas = Areas
halls-areas-about = With the tool <i>Area</i>, a rectangle is an area. <i>Line</i> draws any other outline: each press adds a corner, and a press on the first corner closes the outline. The probability says how likely the bomb is in this area; all areas together have at most 1. Areas do not overlap.
halls-area-name = Area name
halls-area-probability = Probability
halls-name = Name
halls-columns = Columns
halls-rows = Rows
halls-size = Set name and size
halls-open = Open a file
halls-resolution = Metres per pixel (image without YAML)
halls-download = Download

## The file.

halls-file = The hall as a file
halls-file-about = In the drawing, <code>.</code> is floor, <code>#</code> is wall, <code>S</code> is home, and other letters are luggage. <code>dangerous = true</code> marks a dangerous piece. <code>[[area]]</code> begins a named area.
halls-check = Check
halls-use = Use this hall
halls-another = Begin with another hall

## Halls that are kept.

halls-keep-as = Save as
halls-keep-as-about = small letters, digits and -
halls-keep = Save
halls-replace = Replace { $name }
halls-kept = Halls saved in the data folder
halls-discard = Discard { $name }…
halls-discard-asked = Discard <b>{ $name }</b>? The saved hall is then lost. The hall in the editor stays.
halls-discard-for-good = Discard { $name } for good
halls-discarded = The saved hall <b>{ $name }</b> was discarded.
halls-another-kept = Another hall is saved as <b>{ $name }</b>: replace that hall, or choose another name.
halls-opened = This hall is saved as <b>{ $name }</b>.
