# What scripts say: a line each, and in it only values.

## attention

attention-waits = Il bagaglio #{ $id } attende il verdetto.
attention-denied = Questo browser blocca le notifiche di questa pagina: controllare le impostazioni del browser per questo indirizzo.
attention-unknown = Qui questo browser non offre notifiche: per le notifiche serve https.

## console

console-changed = La pagina è cambiata poco prima della pressione: non è stato inviato niente. Controllare la pagina, poi premere di nuovo.
console-judged-safe = La domanda è chiusa: il bagaglio #{ $id } è stato giudicato SICURO da { $by } alle { $time }.
console-judged-danger = La domanda è chiusa: il bagaglio #{ $id } è stato giudicato PERICOLO da { $by } alle { $time }.
console-kept-back = La risposta sul bagaglio #{ $id } è registrata. Resta nascosta finché un altro giudice non ha risposto.
console-withdrawn = La domanda è chiusa: il bagaglio #{ $id } non attende più nessun verdetto.
console-twice = Questa pressione è arrivata troppo presto dopo la precedente e non è stata inviata. Premere di nuovo.
console-refused = hallsweep ha rifiutato il comando ({ $status }).
console-silent = Nessuna risposta. Il comando può ancora essere eseguito: guardare il robot prima di riprovare.
console-cut = Nessun collegamento: il comando non è arrivato.

## editor

editor-at = colonna { $x }, riga { $y }: { $text }
editor-floor = pavimento
editor-wall = parete
editor-home = base
editor-luggage = bagaglio
editor-marked = bagaglio { $mark }
editor-dangerous = bagaglio pericoloso { $mark }
editor-begun-brush = pennello cominciato
editor-begun-line = linea cominciata
editor-begun-rectangle = rettangolo cominciato
editor-area-name = Area { $number }
editor-in-area = nell'area { $name }
editor-begun-outline = contorno cominciato, vertici: { $corners }
editor-area-discard = Eliminare l'area { $name }
editor-rest = Probabilità fuori dalle aree: { $rest }
editor-probability = Dare all'area una probabilità da 0 a 1.
editor-corners = Un'area ha al massimo { $most } vertici: premere sul primo vertice.
editor-sound = La sala è a posto: tutto si può raggiungere.
editor-unsound = La sala si può usare, ma una ricerca non arriva dappertutto:
editor-unchecked = La sala non è ancora controllata.
editor-found-pieceUnreached = il bagaglio «{ $name }» non si può raggiungere: nessuna cella libera accanto porta alla base
editor-found-cellUnreached = questa cella libera non si può raggiungere dalla base
editor-found-more = altri posti che non si possono raggiungere: { $count }
editor-found-noLuggage = la sala non contiene bagagli: una ricerca non ha niente da esaminare
editor-large = Il file ha { $bytes } byte, più del limite di { $most }: avviare hallsweep con --hall FILE.
editor-cut = hallsweep non si raggiunge: riprovare
editor-refused = hallsweep risponde: «{ $detail }»
editor-letters = Tutte le 26 lettere sono in uso: trasformare prima in pavimento uno dei bagagli con lettera.
editor-undrawable = Questa sala qui non si può disegnare: modificare il testo più sotto.
editor-sides = Qui una sala ha da 1 a { $most } colonne e righe.
editor-home-outside = La base resterebbe fuori dalla sala: spostare prima la base.
editor-open = { $file } è aperto: { $width } × { $height } celle, bagagli: { $pieces }

## hall

hall-ruler-metres = { $length } m
hall-ruler-cells = { $length } celle
hall-go = Andare a colonna { $x }, riga { $y }
hall-cell = colonna { $x }, riga { $y }

## laboratory

laboratory-start = Riprodurre
laboratory-pause = Pausa
laboratory-speed = Velocità
laboratory-clock = { $time } di { $seconds } s
laboratory-clock-said = { $time } di { $seconds } secondi
laboratory-answered = hallsweep ha risposto { $status }
laboratory-cannot-move = L'animazione non può partire: { $why }.

## pallet

pallet-slider = Tempo del bancale, in secondi
pallet-player = Riproduzione del bancale
pallet-show = Mostra { $time }
pallet-nothing-held = nessun pacco nelle pinze
pallet-lifted = il pacco è sollevato
pallet-on-floor = il pacco è sul pavimento
pallet-phase = Fase { $phase } di 8, pacco { $parcel } di { $parcels }
pallet-before = Prima della prima fase
pallet-at-the-start = entrambi i robot sono alla posizione di partenza
pallet-where = { $delivered } di { $parcels } nell'area di arrivo; { $parcel }
pallet-all-there = Tutti i pacchi sono nell'area di arrivo
pallet-acknowledged = L'allarme è confermato; entrambi i robot aspettano AVVIA
pallet-nothing-waits = Nulla aspetta l'operatore

## photo

## replay

replay-slider = Tempo del recupero, in secondi
replay-player = Riproduzione del recupero
replay-cannot-move = La riproduzione non può partire: { $why }.

## roomba

roomba-slider = Tempo del Roomba, in secondi
roomba-player = Riproduzione del Roomba
roomba-now = { $phase } · pavimento { $share } % · pareti incontrate { $walls }

## simulator

simulator-unsent = Il comando non è stato inviato: hallsweep non si raggiunge. Riprovare.

## time

time-moment = { $time }, voce { $seq } della missione { $mission }
time-now = adesso
time-pause = Pausa
time-play = Riprodurre
time-cut = Nessun collegamento: il passato non si può mostrare adesso.

## trees

trees-idle = fermo
trees-running = in corso
trees-success = riuscito
trees-failure = fallito
trees-skipped = saltato
trees-empty = vuoto
trees-tick = ciclo { $tick }

## verdict
