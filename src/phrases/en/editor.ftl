# The editor of halls. What its script says too stands with the scripts.

halls-title = Editor of halls
halls-to-simulator = To the simulator
halls-viewer = You are signed in as a viewer: you see the hall and may press STOP. Everything else asks for an operator's key.

## Drawing.

halls-drawing = Drawing
halls-tool = Tool
halls-wall = Wall
halls-floor = Floor
halls-luggage = Luggage
halls-dangerous = Dangerous
halls-home = Home
halls-shape = How it is drawn
halls-brush = Brush
halls-line = Line
halls-rectangle = Rectangle
halls-undo = Undo
halls-redo = Redo
halls-drawing-about = Draw with pointer or finger. By keyboard: arrows move the cursor, space draws (twice for a line or a rectangle), <kbd>c</kbd> gives a begun one up; the letters choose.
halls-plan = Plan of the hall
halls-name = Name
halls-columns = Columns
halls-rows = Rows
halls-size = Set name and size
halls-open = Open a file
halls-resolution = Metres a pixel, of a bare image
halls-download = Download

## The file.

halls-file = The hall as a file
halls-file-about = In the drawing <code>.</code> is floor, <code>#</code> wall, <code>S</code> home, a letter luggage; <code>dangerous = true</code> marks danger.
halls-check = Check
halls-use = Put the robots down in it
halls-another = Begin with another

## Halls that are kept.

halls-keep-as = Keep as
halls-keep-as-about = small letters, digits and -
halls-keep = Keep
halls-replace = Replace { $name }
halls-kept = Kept in the data folder
halls-discard = Discard { $name }…
halls-discard-asked = Discard <b>{ $name }</b>? It is gone then. What stands in the editor stays.
halls-discard-for-good = Discard { $name } for good
halls-discarded = <b>{ $name }</b> is kept no more.
halls-another-kept = Another hall is kept as <b>{ $name }</b>: replace it, or choose another name.
halls-opened = This is the hall that is kept as <b>{ $name }</b>.
