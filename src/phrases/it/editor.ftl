# L'editor delle sale. Quello che dice anche il suo script sta con gli script.

halls-title = Editor delle sale
halls-to-simulator = Al simulatore
halls-viewer = Accesso come osservatore: si vede la sala e si può premere STOP. Per tutto il resto serve la chiave di un operatore.

## Il disegno.

halls-drawing = Disegno
halls-tool = Strumento
halls-wall = Parete
halls-floor = Pavimento
halls-luggage = Bagaglio
halls-dangerous = Pericoloso
halls-home = Base
halls-shape = Come si disegna
halls-brush = Pennello
halls-line = Linea
halls-rectangle = Rettangolo
halls-undo = Annulla
halls-redo = Ripristina
halls-drawing-about = Disegnare con il puntatore o con il dito. Con la tastiera: le frecce muovono il cursore, lo spazio disegna (due volte per una linea o un rettangolo), <kbd>c</kbd> rinuncia a quello cominciato; le lettere scelgono.
halls-plan = Pianta della sala
halls-name = Nome
halls-columns = Colonne
halls-rows = Righe
halls-size = Impostare nome e dimensioni
halls-open = Aprire un file
halls-resolution = Metri per pixel, per un'immagine da sola
halls-download = Scaricare

## Il file.

halls-file = La sala come file
halls-file-about = Nel disegno <code>.</code> è pavimento, <code>#</code> parete, <code>S</code> la base, una lettera un bagaglio; <code>dangerous = true</code> segna il pericolo.
halls-check = Controllare
halls-use = Collocare i robot in questa sala
halls-another = Cominciare da un'altra

## Halls that are kept.

halls-keep-as = Conservare come
halls-keep-as-about = lettere minuscole, cifre e -
halls-keep = Conservare
halls-replace = Sostituire { $name }
halls-kept = Conservate nella cartella dei dati
halls-discard = Eliminare { $name }…
halls-discard-asked = Eliminare <b>{ $name }</b>? Poi non ci sarà più. Ciò che è nell'editor resta.
halls-discard-for-good = Eliminare { $name } per sempre
halls-discarded = <b>{ $name }</b> non è più conservata.
halls-another-kept = Un'altra sala è conservata come <b>{ $name }</b>: sostituirla, o scegliere un altro nome.
halls-opened = Questa è la sala conservata come <b>{ $name }</b>.
